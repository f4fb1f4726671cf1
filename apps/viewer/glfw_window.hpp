// A window with OpenGL 4.5 by GLFW, gone with its owner.
#pragma once

#include <epoxy/gl.h>
// epoxy before GLFW, which would bring its own declarations of OpenGL
#include <GLFW/glfw3.h>

#include <string>

namespace sightline::viewer {

class GlfwWindow {
 public:
  /// Its OpenGL is current afterwards. Throws gl::Unavailable: no display, old OpenGL.
  GlfwWindow(int width, int height, const std::string& title);
  ~GlfwWindow();
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;

  [[nodiscard]] GLFWwindow* get() const { return window_; }
  [[nodiscard]] bool held(int key) const { return glfwGetKey(window_, key) == GLFW_PRESS; }

 private:
  GLFWwindow* window_ = nullptr;
};

}  // namespace sightline::viewer
