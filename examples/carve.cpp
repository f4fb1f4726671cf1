// A block with tunnels along its three axes and a ball taken out of a corner, by Boolean operations of BSP trees.
// carve [solid.glb]: also writes the solid.
#include <cmath>
#include <cstdio>

#include "sightline/index/bsp_boolean.hpp"
#include "sightline/scene/generate/shapes.hpp"
#include "sightline/scene/save/glb.hpp"

using namespace sightline;

namespace {

PolygonSet solid(const Mesh& mesh, double scale = 1.0, const glm::dvec3& at = {0, 0, 0}) {
  PolygonSet set;
  for (const glm::uvec3& t : mesh.triangles) {
    glm::dvec3 corners[3];
    for (int k = 0; k < 3; ++k) corners[k] = scale * glm::dvec3(mesh.positions[t[k]]) + at;
    set.add(corners);
  }
  return set;
}

}  // namespace

int main(int count, char** arguments) {
  PolygonSet block = solid(make_box({-2, -2, -2}, {2, 2, 2}));
  PolygonSet tunnels = solid(make_box({-3, -1, -1}, {3, 1, 1}));
  tunnels = boolean_of(tunnels, solid(make_box({-1, -3, -1}, {1, 3, 1})), BooleanOp::unite).polygons;
  tunnels = boolean_of(tunnels, solid(make_box({-1, -1, -3}, {1, 1, 3})), BooleanOp::unite).polygons;
  block = boolean_of(block, tunnels, BooleanOp::subtract).polygons;
  const double frame_volume = enclosed_volume(block);  // 64 less a cross of seven cubes of 2 x 2 x 1, middle 2 x 2 x 2
  block = boolean_of(block, solid(make_ball(48, 24), 1.4, {2, 2, 2}), BooleanOp::subtract).polygons;
  std::printf("%.6f m3 after the tunnels, %.6f m3 after the ball, %zu polygons\n", frame_volume, enclosed_volume(block),
              block.size());
  if (count > 1) {
    Mesh mesh;
    for (std::size_t i = 0; i < block.size(); ++i) {
      const auto base = static_cast<std::uint32_t>(mesh.positions.size());
      for (const glm::dvec3& p : block[i]) mesh.positions.emplace_back(p);
      for (std::uint32_t k = 2; k < block[i].size(); ++k) mesh.triangles.push_back({base, base + k - 1, base + k});
    }
    SceneBuilder builder;
    builder.add_object(builder.add_mesh(std::move(mesh)), identity_affine(), "carved");
    save_glb(builder.build(), arguments[1]);
  }
  return std::abs(frame_volume - 32.0) < 1e-9 ? 0 : 1;
}
