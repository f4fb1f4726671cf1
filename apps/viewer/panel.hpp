// The widgets over the picture: figures, legend, frame-time graph, answers, help. Needs a current Dear ImGui frame.
#pragma once

#include "viewer/session.hpp"

namespace sightline::viewer {

void show_panel(Session& session);

}  // namespace sightline::viewer
