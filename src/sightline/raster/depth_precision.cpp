#include "sightline/raster/depth_precision.hpp"

#include <algorithm>

#include "sightline/raster/pipeline.hpp"

namespace sightline::raster {
namespace {

/// A plane over the whole image, at one distance at the left edge and at another at the right one.
struct Slanted {
  static constexpr std::size_t varyings = 0;
  static constexpr bool discards = false, writes_depth = false;
  double left, right, near, far;
  glm::vec4 colour;

  [[nodiscard]] ClipVertex<0> vertex(std::uint32_t i) const {
    const double distance = i % 2 == 0 ? left : right;
    const double z = ((far + near) * distance - 2 * far * near) / (far - near);
    const glm::dvec4 corner(i % 2 == 0 ? -distance : distance, i < 2 ? -distance : distance, z, distance);
    return {glm::vec4(corner), {}};
  }
  bool fragment(const Fragment<0>&, FragmentResult& out) const {
    out.colour = colour;
    return true;
  }
};

}  // namespace

double fighting_share(DepthFormat format, double distance, double apart, double near, double far) {
  Target target(256, 4, format);
  DrawCounts counts;
  const glm::uvec3 triangles[] = {{0, 1, 3}, {0, 3, 2}};
  const glm::vec4 white(1.0f);
  for (const double behind : {apart, 0.0})
    draw(State(),
         Slanted{0.99 * distance + behind, 1.01 * distance + behind, near, far, behind > 0 ? glm::vec4(0.0f) : white},
         triangles, target, counts);
  const auto seen = std::count(target.colour.begin(), target.colour.end(), pack_colour(white));
  return 1.0 - static_cast<double>(seen) / static_cast<double>(target.colour.size());
}

}  // namespace sightline::raster
