// bench_frustum [boxes]: a million boxes against a frustum that holds a tenth of them. Contenders: reading the same
// bytes, the one-by-one reference, SIMD over arrays, and the registry's cullers over a scene of that many objects; what
// the option `corners` saves among large boxes. CPU time of one thread, medians, one run; answers are compared before
// anything is timed.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <vector>

#include "sightline/geometry/frustum_boxes.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/generate/random.hpp"

namespace {

using namespace sightline;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Scene boxes_scene(std::uint32_t count) {
  Mesh cube;
  for (int i = 0; i < 8; ++i)
    cube.positions.emplace_back((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
  cube.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  SceneBuilder builder;
  const MeshId mesh = builder.add_mesh(cube);
  Random random(1);
  for (std::uint32_t i = 0; i < count; ++i)
    builder.add_object(mesh, {{1, 0, 0},
                              {0, 1, 0},
                              {0, 0, 1},
                              {random.range(-1000, 1000), random.range(-1000, 1000), random.range(-1000, 1000)}});
  return builder.build();
}

struct Contender {
  const char* name;
  std::function<std::size_t()> run;
  std::vector<double> seconds;
};

/// Large boxes around a small frustum: how many pass all planes though they miss the frustum's own box.
int corners_saved() {
  Mesh cube;
  for (int i = 0; i < 8; ++i)
    cube.positions.emplace_back((i & 1) != 0 ? 60 : -60, (i & 2) != 0 ? 60 : -60, (i & 4) != 0 ? 60 : -60);
  cube.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}};
  SceneBuilder builder;
  const MeshId mesh = builder.add_mesh(cube);
  Random random(2);
  for (int i = 0; i < 20000; ++i)
    builder.add_object(
        mesh,
        {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {random.range(-300, 300), random.range(-300, 300), random.range(-300, 300)}});
  const Scene scene = builder.build();
  const IndexedScene indexed = index_scene(scene);
  View view = look_along({0, 0, 0}, {1, 0.2, 0.3});
  view.far = 100;
  const VisibleSet all = VisibleSet::all(scene.objects().size());
  std::size_t found[2] = {0, 0};
  for (const bool corners : {false, true}) {
    VisibleSet visible;
    Counters counters;
    make_culler(corners ? "frustum_hierarchical:corners=on" : "frustum_hierarchical", indexed)
        ->cull(view, all, visible, counters);
    found[corners ? 1 : 0] = visible.count();
    std::printf("20000 boxes of 120 m, far plane at 100 m, corners=%-3s: %zu reported, %llu rejects by corners\n",
                corners ? "on" : "off", visible.count(), static_cast<unsigned long long>(counters.corner_rejects));
  }
  return found[1] <= found[0] ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  const auto boxes_wanted = static_cast<std::uint32_t>(count > 1 ? std::atoi(arguments[1]) : 1000000);
  const ThreadLimit one(1);
  const Scene scene = boxes_scene(boxes_wanted);
  const IndexedScene indexed = index_scene(scene);
  const BoxArrays boxes(scene.object_bounds());
  View view = look_along({0, 0, 0}, {1, 0.1, 0.2});
  view.far = 2000;
  const Frustum frustum = view_frustum(view, reach(scene.bounds()));
  const VisibleSet all = VisibleSet::all(boxes.count);
  VisibleSet visible;
  Counters counters;
  std::vector<std::uint32_t> ids(boxes.count + 64);
  const auto linear = make_culler("frustum_linear", indexed),
             hierarchical = make_culler("frustum_hierarchical", indexed);
  const auto cull = [&](Culler& culler) {
    culler.cull(view, all, visible, counters);
    return visible.count();
  };
  std::vector<Contender> contenders{
      {"read the bytes",
       [&] {
         float sum[8] = {};
         for (int axis = 0; axis < 3; ++axis)
           for (std::size_t i = 0; i + 8 <= boxes.count; i += 8)
             for (std::size_t k = 0; k < 8; ++k) sum[k] += boxes.lo[axis][i + k] + boxes.hi[axis][i + k];
         return static_cast<std::size_t>(sum[0] != 1.0f) + static_cast<std::size_t>(sum[7] != 1.0f);
       },
       {}},
      {"one by one", [&] { return boxes_in_frustum_scalar(boxes, frustum, ids.data()); }, {}},
      {"SIMD, id list", [&] { return boxes_in_frustum(boxes, frustum, ids.data()); }, {}},
      {"frustum_linear", [&] { return cull(*linear); }, {}},
      {"frustum_hierarchical", [&] { return cull(*hierarchical); }, {}}};
  const std::size_t expected = contenders[1].run();
  for (std::size_t i = 2; i < contenders.size(); ++i)
    if (contenders[i].run() != expected) {
      std::fprintf(stderr, "bench_frustum: %s gives another answer\n", contenders[i].name);
      return 1;
    }
  for (int round = 0; round < 15; ++round)
    for (Contender& c : contenders)
      for (int frame = 0; frame < 4; ++frame) {  // the first finds the caches full of another's data
        const double start = cpu_seconds();
        if (c.run() == 0) return 1;
        if (frame > 0) c.seconds.push_back(cpu_seconds() - start);
      }
  const auto median = [](std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return v[v.size() / 2];
  };
  std::printf(
      "%zu boxes, %zu in view, one thread; wanted: SIMD with id list 10x one by one and within 1.5x reading, "
      "frustum_hierarchical 4x frustum_linear\n",
      boxes.count, expected);
  const double read = median(contenders[0].seconds), reference = median(contenders[1].seconds),
               simd = median(contenders[3].seconds);
  for (const Contender& c : contenders)
    std::printf("%-22s %8.3f ms   %6.2fx reading   %6.2fx one by one   %6.2fx frustum_linear\n", c.name,
                1e3 * median(c.seconds), median(c.seconds) / read, reference / median(c.seconds),
                simd / median(c.seconds));
  return corners_saved();
}
