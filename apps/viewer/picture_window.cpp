#include "viewer/picture_window.hpp"

#include <algorithm>

#include "viewer/glfw_window.hpp"

namespace sightline::viewer {
namespace {

/// A texture that is copied to the window, made anew where the size changes.
class Copied {
 public:
  Copied() = default;
  ~Copied() { release(); }
  Copied(const Copied&) = delete;
  Copied& operator=(const Copied&) = delete;

  void show(const Frame& frame) {
    if (frame.width != width_ || frame.height != height_) make(frame.width, frame.height);
    glTextureSubImage2D(texture_, 0, 0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, frame.colour.data());
    // Rows of frames run from the top, those of OpenGL from the bottom.
    glBlitNamedFramebuffer(framebuffer_, 0, 0, 0, width_, height_, 0, height_, width_, 0, GL_COLOR_BUFFER_BIT,
                           GL_NEAREST);
  }

 private:
  void make(int width, int height) {
    release();
    width_ = width;
    height_ = height;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture_);
    glTextureStorage2D(texture_, 1, GL_RGBA8, width, height);
    glCreateFramebuffers(1, &framebuffer_);
    glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, texture_, 0);
  }
  void release() {
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteTextures(1, &texture_);
    framebuffer_ = texture_ = 0;
  }
  GLuint texture_ = 0, framebuffer_ = 0;
  int width_ = 0, height_ = 0;
};

}  // namespace

void run_picture_window(const std::string& title, int width, int height,
                        const std::function<void(double, const HeldKeys&, int, int, Frame&)>& draw) {
  const GlfwWindow window(width, height, title);
  glfwSetInputMode(window.get(), GLFW_STICKY_KEYS, GLFW_TRUE);  // a short press counts, too
  Copied copied;
  Frame frame;
  double last = glfwGetTime();
  while (glfwWindowShouldClose(window.get()) == GLFW_FALSE && !window.held(GLFW_KEY_Q) &&
         !window.held(GLFW_KEY_ESCAPE)) {
    glfwPollEvents();
    int w = 0, h = 0;
    glfwGetFramebufferSize(window.get(), &w, &h);
    if (w == 0 || h == 0) {  // minimised
      glfwWaitEventsTimeout(0.1);
      continue;
    }
    const double now = glfwGetTime(), seconds = std::min(now - last, 0.1);
    last = now;
    const HeldKeys keys{window.held(GLFW_KEY_W) || window.held(GLFW_KEY_UP),
                        window.held(GLFW_KEY_S) || window.held(GLFW_KEY_DOWN),
                        window.held(GLFW_KEY_A) || window.held(GLFW_KEY_LEFT),
                        window.held(GLFW_KEY_D) || window.held(GLFW_KEY_RIGHT),
                        window.held(GLFW_KEY_COMMA),
                        window.held(GLFW_KEY_PERIOD)};
    draw(seconds, keys, w, h, frame);
    copied.show(frame);
    glfwSwapBuffers(window.get());
  }
}

}  // namespace sightline::viewer
