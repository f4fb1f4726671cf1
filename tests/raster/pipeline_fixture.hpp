// Triangles given in the window, for tests of the pipeline.
#pragma once

#include <vector>

#include "sightline/raster/pipeline.hpp"

namespace sightline::raster {

struct WindowVertex {
  float x, y, z;  // pixels, window depth
};

/// Orthographic: window positions come out as they went in (sizes that are powers of two, multiples of 1/256 pixel).
struct WindowProgram {
  static constexpr std::size_t varyings = 1;
  static constexpr bool discards = false, writes_depth = false;
  std::vector<WindowVertex> vertices;
  glm::vec4 colour{1.0f};
  float width = 0, height = 0;

  [[nodiscard]] ClipVertex<1> vertex(std::uint32_t i) const {
    const WindowVertex& v = vertices[i];
    return {{2 * v.x / width - 1, 1 - 2 * v.y / height, 2 * v.z - 1, 1}, {v.z}};
  }
  bool fragment(const Fragment<1>&, FragmentResult& out) const {
    out.colour = colour;
    return true;
  }
  [[nodiscard]] std::vector<glm::uvec3> triangles() const {
    std::vector<glm::uvec3> t;
    for (std::uint32_t i = 0; i + 2 < vertices.size(); i += 3) t.emplace_back(i, i + 1, i + 2);
    return t;
  }
};

/// Draws window triangles in one colour.
inline DrawCounts draw_window(const State& state, std::vector<WindowVertex> vertices, const glm::vec4& colour,
                              Target& target) {
  const WindowProgram program{std::move(vertices), colour, static_cast<float>(target.width),
                              static_cast<float>(target.height)};
  const auto triangles = program.triangles();
  DrawCounts counts;
  draw(state, program, triangles, target, counts);
  return counts;
}

/// Two triangles that cover [x0, x1] x [y0, y1] at one depth, counter-clockwise as seen.
inline std::vector<WindowVertex> rectangle(float x0, float y0, float x1, float y1, float z) {
  return {{x0, y0, z}, {x0, y1, z}, {x1, y1, z}, {x0, y0, z}, {x1, y1, z}, {x1, y0, z}};
}

/// The whole image at one depth.
inline std::vector<WindowVertex> screen(const Target& t, float z) {
  return rectangle(0, 0, static_cast<float>(t.width), static_cast<float>(t.height), z);
}

}  // namespace sightline::raster
