#include "gl/target.hpp"

#include <epoxy/gl.h>

#include "gl/context.hpp"
#include "gl/projection.hpp"

namespace sightline::gl {
namespace {

Texture make_texture(GLenum format, int width, int height) {
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &name);
  Texture texture(name);
  glTextureStorage2D(name, 1, format, width, height);
  if (glGetError() == GL_OUT_OF_MEMORY)
    throw Unavailable("OpenGL has no memory for a picture of " + std::to_string(width) + "x" + std::to_string(height));
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTextureParameteri(name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

}  // namespace

void Target::resize(int width, int height) {
  if (framebuffer_ && width == width_ && height == height_) return;
  colour_ = make_texture(GL_RGBA8, width, height);
  id_ = make_texture(GL_R32UI, width, height);
  depth_ = make_texture(GL_DEPTH_COMPONENT32F, width, height);
  GLuint name = 0;
  glCreateFramebuffers(1, &name);
  framebuffer_ = Framebuffer(name);
  glNamedFramebufferTexture(name, GL_COLOR_ATTACHMENT0, colour_.name(), 0);
  glNamedFramebufferTexture(name, GL_COLOR_ATTACHMENT1, id_.name(), 0);
  glNamedFramebufferTexture(name, GL_DEPTH_ATTACHMENT, depth_.name(), 0);
  const GLenum buffers[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glNamedFramebufferDrawBuffers(name, 2, buffers);
  if (glCheckNamedFramebufferStatus(name, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Unavailable("OpenGL cannot draw into a picture of " + std::to_string(width) + "x" + std::to_string(height));
  width_ = width;
  height_ = height;
}

void Target::read_ids(std::vector<std::uint32_t>& ids) const {
  ids.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.name());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadBuffer(GL_COLOR_ATTACHMENT1);
  glReadPixels(0, 0, width_, height_, GL_RED_INTEGER, GL_UNSIGNED_INT, ids.data());
}

void Target::read_back(const View& view, Frame& frame) const {
  frame.clear(width_, height_);
  std::vector<std::uint32_t> ids, colours(frame.object.size());
  std::vector<float> depths(frame.object.size());
  read_ids(ids);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, colours.data());
  glReadPixels(0, 0, width_, height_, GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
  frame.colour.resize(frame.object.size());
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const std::size_t from = frame.index(x, height_ - 1 - y), to = frame.index(x, y);
      frame.object[to] = ids[from];
      frame.colour[to] = colours[from];
      if (ids[from] != no_object) frame.depth[to] = static_cast<float>(metres(view, depths[from]));
    }
}

}  // namespace sightline::gl
