#include "gl/presentation.hpp"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>

#include "gl/projection.hpp"

namespace sightline::gl {
namespace {

constexpr char whole_screen[] = R"(#version 450 core
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }
)";

// Distance along the view direction is (a + b d) / (c + e d) of the stored depth d, whatever the projection.
constexpr char depth_fragment[] = R"(#version 450 core
layout(binding = 0) uniform sampler2D depth;
layout(location = 0) uniform vec4 metres;
layout(location = 1) uniform vec2 range;
layout(location = 0) out vec4 shaded;
void main() {
  float d = texelFetch(depth, ivec2(gl_FragCoord.xy), 0).r;
  float distance = (metres.x + metres.y * d) / (metres.z + metres.w * d);
  float t = clamp(log(distance / range.x) / max(log(range.y / range.x), 1e-6), 0.0, 1.0);
  shaded = d == 0.0 ? vec4(0.05, 0.07, 0.12, 1.0) : vec4(vec3(1.0 - 0.8 * t), 1.0);
}
)";

glm::vec4 metres_of_depth(const View& view) {
  const auto near = static_cast<float>(view.near), far = static_cast<float>(view.far);
  if (view.projection == Projection::orthographic) return {far, near - far, 1.0f, 0.0f};
  if (std::isinf(view.far)) return {near, 0.0f, 0.0f, 1.0f};
  return {near * far, 0.0f, near, far - near};
}

glm::vec2 range_of(const Target& target, const View& view) {
  std::vector<float> depth(static_cast<std::size_t>(target.width()) * static_cast<std::size_t>(target.height()));
  glGetTextureImage(target.depth_texture(), 0, GL_DEPTH_COMPONENT, GL_FLOAT,
                    static_cast<GLsizei>(depth.size() * sizeof(float)), depth.data());
  float nearest = 0.0f, farthest = 1.0f;  // reversed: large is near
  for (const float d : depth) {
    if (d == 0.0f) continue;
    nearest = std::max(nearest, d);
    farthest = std::min(farthest, d);
  }
  if (nearest == 0.0f) return {1.0f, 2.0f};
  return {metres(view, nearest), metres(view, farthest)};
}

}  // namespace

Canvas::Canvas(int width, int height) {
  GLuint colour = 0, framebuffer = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &colour);
  colour_ = Texture(colour);
  glTextureStorage2D(colour, 1, GL_RGBA8, width, height);
  glCreateFramebuffers(1, &framebuffer);
  framebuffer_ = Framebuffer(framebuffer);
  glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, colour, 0);
  if (glCheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Unavailable("no memory for a picture of this size");
}

std::vector<std::uint8_t> read_rgb(unsigned framebuffer, int width, int height) {
  const std::size_t row = 3 * static_cast<std::size_t>(width);
  std::vector<std::uint8_t> below(row * static_cast<std::size_t>(height)), rows;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
  glReadBuffer(framebuffer == 0 ? GL_BACK : GL_COLOR_ATTACHMENT0);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, below.data());
  rows.reserve(below.size());
  for (int y = height; y-- > 0;) {
    const auto from = below.begin() + static_cast<std::ptrdiff_t>(row * static_cast<std::size_t>(y));
    rows.insert(rows.end(), from, from + static_cast<std::ptrdiff_t>(row));
  }
  return rows;
}

Presentation::Presentation(Context& context) : depth_program_(make_program(whole_screen, depth_fragment)) {
  GLuint array = 0;
  glCreateVertexArrays(1, &array);
  no_attributes_ = VertexArray(array);
  context.check("preparing the presentation");
}

void Presentation::show_colour(const Target& target, unsigned framebuffer) {
  glNamedFramebufferReadBuffer(target.framebuffer(), GL_COLOR_ATTACHMENT0);
  glBlitNamedFramebuffer(target.framebuffer(), framebuffer, 0, 0, target.width(), target.height(), 0, 0, target.width(),
                         target.height(), GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
}

void Presentation::show_depth(const Target& target, const View& view, unsigned framebuffer) {
  const glm::vec2 range = range_of(target, view);
  const glm::vec4 map = metres_of_depth(view);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, target.width(), target.height());
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glUseProgram(depth_program_.name());
  glBindTextureUnit(0, target.depth_texture());
  glUniform4f(0, map.x, map.y, map.z, map.w);
  glUniform2f(1, range.x, std::max(range.y, 1.0001f * range.x));
  glBindVertexArray(no_attributes_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace sightline::gl
