// An occlusion buffer that has warmed up allocates nothing from frame to frame: counted in operator new.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "agreement/cases.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/occlusion_buffer.hpp"

namespace {
std::atomic<std::size_t> allocations{0};
}

#ifdef __SANITIZE_ADDRESS__
constexpr bool counted = false;  // the sanitizer has operators of its own
#else
constexpr bool counted = true;
// Not inlined, else GCC sees memory of operator new go to free().
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
#endif

namespace sightline {
namespace {

TEST(OcclusionBufferAllocations, NoneAfterTheFirstFrames) {
  if (!counted) GTEST_SKIP() << "SKIPPED: allocations cannot be counted under a sanitizer";
  const ThreadLimit one(1);  // what oneTBB allocates is its own affair
  const Scene scene = generate_scene("building", {.objects = 300, .triangles = 0, .seed = 3});
  std::vector<OccluderMesh> meshes;
  for (const Mesh& mesh : scene.meshes()) meshes.push_back(make_occluder(mesh.positions, mesh.triangles));
  std::vector<OccluderInstance> all;
  for (const Object& object : scene.objects()) all.push_back({&meshes[object.mesh], object.transform});
  const std::vector<View> views = cases::hard_views(scene, 12, 8);
  const std::vector<Aabb> boxes = scene.object_bounds();
  std::vector<std::uint8_t> seen(boxes.size());
  OcclusionBuffer buffer;
  const Mesh& raw = scene.meshes()[0];
  const auto frames = [&] {
    for (const View& view : views) {
      buffer.begin(view, 160, 90);
      buffer.add_occluders(all);
      buffer.add_occluder(raw.positions, raw.triangles, identity_affine());
      buffer.add_occluder(meshes[0], identity_affine());
      buffer.test(boxes, seen);
      for (const Aabb& box : boxes) seen[0] = buffer.may_be_seen(box) ? 1 : 0;
    }
  };
  frames();
  frames();
  const std::size_t before = allocations;
  frames();
  EXPECT_EQ(allocations - before, 0u);
  EXPECT_GT(before, 100u) << "the counter counts";
}

}  // namespace
}  // namespace sightline
