#include "gl/line_drawing.hpp"

#include <epoxy/gl.h>

#include <algorithm>
#include <glm/gtc/type_ptr.hpp>

#include "gl/projection.hpp"

namespace sightline::gl {
namespace {

constexpr char vertex[] = R"(#version 450 core
layout(location = 0) in vec3 from_eye;
layout(location = 1) in vec4 tint;
layout(location = 0) uniform mat4 clip;
out vec4 colour;
void main() {
  gl_Position = clip * vec4(from_eye, 1.0);
  gl_Position.z += 1e-4 * gl_Position.z;  // towards the eye, as depth is reversed: a box shows on its own content
  colour = tint;
}
)";

constexpr char fragment[] = R"(#version 450 core
in vec4 colour;
layout(location = 0) out vec4 shaded;
void main() { shaded = colour; }
)";

struct Vertex {
  glm::vec3 from_eye;
  std::uint32_t colour;
};

}  // namespace

void add_box(std::vector<Line>& lines, const Aabb& box, std::uint32_t colour) {
  if (box.empty()) return;
  for (int corner = 0; corner < 8; ++corner)
    for (int axis = 1; axis < 8; axis <<= 1)
      if ((corner & axis) == 0)
        lines.push_back({glm::dvec3(box.corner(corner)), glm::dvec3(box.corner(corner | axis)), colour});
}

void add_frustum(std::vector<Line>& lines, const View& view, double far, std::uint32_t colour) {
  glm::dvec3 corners[2][4];
  for (int c = 0; c < 4; ++c) {
    const PixelRay ray = pixel_ray(view, c == 1 || c == 2 ? view.width : 0, c >= 2 ? view.height : 0);
    corners[0][c] = ray.origin + view.near * ray.direction;
    corners[1][c] = ray.origin + std::max(far, view.near) * ray.direction;
  }
  for (int c = 0; c < 4; ++c) {
    lines.push_back({corners[0][c], corners[1][c], colour});
    for (const auto& end : corners) lines.push_back({end[c], end[(c + 1) % 4], colour});
  }
}

LineDrawing::LineDrawing(Context& context) : program_(make_program(vertex, fragment)) {
  GLuint array = 0;
  glCreateVertexArrays(1, &array);
  array_ = VertexArray(array);
  glEnableVertexArrayAttrib(array, 0);
  glEnableVertexArrayAttrib(array, 1);
  glVertexArrayAttribFormat(array, 0, 3, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribFormat(array, 1, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Vertex, colour));
  glVertexArrayAttribBinding(array, 0, 0);
  glVertexArrayAttribBinding(array, 1, 0);
  context.check("preparing lines");
}

void LineDrawing::draw(const View& view, std::span<const Line> lines, const Target& target) {
  if (lines.empty()) return;
  std::vector<Vertex> corners;
  corners.reserve(2 * lines.size());
  for (const Line& line : lines) {
    corners.push_back({glm::vec3(line.from - view.eye), line.colour});
    corners.push_back({glm::vec3(line.to - view.eye), line.colour});
  }
  vertices_.fill(corners.data(), corners.size() * sizeof(Vertex));
  glVertexArrayVertexBuffer(array_.name(), 0, vertices_.name(), 0, sizeof(Vertex));
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer());
  glViewport(0, 0, target.width(), target.height());
  glUseProgram(program_.name());
  glUniformMatrix4fv(0, 1, GL_FALSE, glm::value_ptr(glm::mat4(reversed_projection(view))));
  glBindVertexArray(array_.name());
  glDisable(GL_POLYGON_OFFSET_FILL);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GEQUAL);
  glDepthMask(GL_FALSE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glColorMaski(1, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);  // ids stay those of objects
  glDrawArrays(GL_LINES, 0, static_cast<GLsizei>(corners.size()));
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
}

}  // namespace sightline::gl
