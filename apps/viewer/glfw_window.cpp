#include "viewer/glfw_window.hpp"

#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>

#include "gl/context.hpp"

namespace sightline::viewer {
namespace {

std::string last_error() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text == nullptr ? "unknown reason" : text;
}

[[noreturn]] int window_is_gone(void* /*display*/, void* /*event*/) {
  std::fputs("sightline: the window was taken away\n", stderr);
  std::_Exit(4);  // from within Xlib nothing can be thrown, and what is OpenGL's cannot be given back
}

/// A window that another client destroys, or a server that goes, is an error of Xlib in the middle of any frame. Xlib
/// prints five lines and exits; here it is one line and the code of what is not available.
void expect_the_window_to_go() {
  void* const xlib = dlopen("libX11.so.6", RTLD_LAZY | RTLD_NOLOAD);  // loaded by GLFW, if it is X that it speaks to
  if (xlib == nullptr) return;
  for (const char* setter : {"XSetErrorHandler", "XSetIOErrorHandler"})
    if (void* const set = dlsym(xlib, setter); set != nullptr)
      reinterpret_cast<void* (*)(int (*)(void*, void*))>(set)(window_is_gone);
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
  expect_the_window_to_go();
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
}

GlfwWindow::~GlfwWindow() {
  glfwDestroyWindow(window_);
  glfwTerminate();
}

}  // namespace sightline::viewer
