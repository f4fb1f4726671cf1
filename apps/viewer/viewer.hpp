// The viewer as a program part: a window with a session in it, or a picture of one without a window.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "viewer/session.hpp"

namespace sightline::viewer {

/// What is drawn without a window.
struct PictureConfig {
  int width = 1280, height = 720;
  std::string press;               // keys pressed one after the other, a frame after each; upper case
  int settle_frames = 4;           // frames drawn before the first key, so that temporal methods have a past
  int click_x = -1, click_y = -1;  // pixel clicked at the end; -1: none
};

/// Rows from the top, three bytes a pixel; panels included. Throws InputError, gl::Unavailable.
std::vector<std::uint8_t> picture_of(SessionConfig config, const IndexedScene& scene, const PictureConfig& picture);

/// Opens a window and runs until it is closed. Throws InputError, gl::Unavailable: no display, old OpenGL.
void run_window(SessionConfig config, const IndexedScene& scene, int width, int height);

}  // namespace sightline::viewer
