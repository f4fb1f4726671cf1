// A window that shows pictures made by software, and tells which keys are held: for the maze.
#pragma once

#include <functional>
#include <string>

#include "sightline/core/frame.hpp"

namespace sightline::viewer {

/// W A S D, arrows (left and right turn), comma and period aside.
struct HeldKeys {
  bool forward = false, back = false, turn_left = false, turn_right = false, left = false, right = false;
};

/// Opens a window and shows the colours of the frame that draw(seconds since the last one, keys, width, height, frame)
/// fills, until it is closed or Q or Escape is pressed. Throws gl::Unavailable: no display, old OpenGL.
void run_picture_window(const std::string& title, int width, int height,
                        const std::function<void(double, const HeldKeys&, int, int, Frame&)>& draw);

}  // namespace sightline::viewer
