#include "viewer/glfw_window.hpp"

#include "gl/context.hpp"

namespace sightline::viewer {
namespace {

std::string last_error() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text == nullptr ? "unknown reason" : text;
}

}  // namespace

GlfwWindow::GlfwWindow(int width, int height, const std::string& title) {
  if (glfwInit() != GLFW_TRUE) throw gl::Unavailable("no window can be opened: " + last_error());
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (window_ == nullptr) {
    const std::string reason = last_error();
    glfwTerminate();
    throw gl::Unavailable("no window with OpenGL 4.5 can be opened: " + reason);
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
}

GlfwWindow::~GlfwWindow() {
  glfwDestroyWindow(window_);
  glfwTerminate();
}

}  // namespace sightline::viewer
