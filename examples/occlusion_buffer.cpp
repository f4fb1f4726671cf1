// The README's second example: an engine with a scene of its own asks the occlusion buffer, without any other part of
// sightline: a wall as triangles, a tower that turns, and three thousand crates behind them.
#include <cstdint>
#include <cstdio>
#include <vector>

#include "sightline/raster/occlusion_buffer.hpp"

int main() {
  using namespace sightline;
  std::vector<Aabb> crates;  // the engine's own bounds, world space
  for (int i = 0; i < 3000; ++i) {
    const glm::vec3 at(static_cast<float>(i % 60 - 30), 0.0f, static_cast<float>(-12 - i / 60));
    crates.push_back({at, at + 0.8f});
  }
  // [readme]
  const std::vector<glm::vec3> corners{{-4, 0, -10}, {4, 0, -10}, {4, 3, -10}, {-4, 3, -10}};
  const std::vector<glm::uvec3> quad{{0, 1, 2}, {0, 2, 3}};
  const OccluderMesh tower = make_occluder(corners, quad);  // once: for meshes that stay
  Affine turned = identity_affine();                        // mesh to world
  turned[0] = {0, 0, 1}, turned[2] = {-1, 0, 0}, turned[3] = {9, 0, -20};

  OcclusionBuffer buffer;  // keeps its memory: no allocation after the first frames
  std::vector<std::uint8_t> seen(crates.size());
  std::size_t drawn = 0;
  for (int frame = 0; frame < 100; ++frame) {
    View view = look_along({0.1 * frame, 1.7, 0}, {0, 0, -1});  // 1280 x 720, 60 degrees; all fields can be set
    view.near = 0.05;
    buffer.begin(view, 320, 180);                           // a quarter of the width hides no less safely
    buffer.add_occluder(tower, turned);                     // opaque things only, near ones first
    buffer.add_occluder(corners, quad, identity_affine());  // triangles that change every frame
    buffer.test(crates, seen);                              // many boxes: SIMD and all threads
    for (const std::uint8_t s : seen) drawn += s;
    if (buffer.may_be_seen(Sphere{{0, 3, -40}, 2.0f}) && frame == 0) return 1;  // behind the wall
  }
  std::printf("%zu of %zu crates may be seen per frame\n", drawn / 100, crates.size());
  // [/readme]
  return drawn > 0 && drawn < 100 * crates.size() / 2 ? 0 : 1;
}
