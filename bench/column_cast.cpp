// bench_column_cast: 2.5-D column casting beside rays through every pixel of the same maze as a 3-D scene (checklist
// 13.19). Contenders: column_cast with and without textures, the oracle (Embree packets), one ray at a time over the
// plain hierarchy, the z-buffer. One thread, medians of interleaved rounds; ids are compared before anything is timed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <vector>

#include "sightline/oracle/oracle.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/scene_rays.hpp"
#include "sightline/registry.hpp"
#include "sightline/surface/column_cast.hpp"

namespace {

using namespace sightline;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Contender {
  const char* name;
  std::function<void(const View&, Frame&)> draw;
  std::vector<double> seconds;
};

/// A frame may differ from the truth at pixels on edges, not elsewhere: here one in five hundred.
bool agrees(const Frame& frame, const Frame& truth) {
  std::size_t differ = 0;
  for (std::size_t i = 0; i < truth.object.size(); ++i) differ += frame.object[i] != truth.object[i] ? 1 : 0;
  return differ * 500 <= truth.object.size();
}

}  // namespace

int main() {
  const ThreadLimit one(1);
  const GridMap map = make_maze(63, 63, 3, 0.3);
  const Scene scene = extrude(map);
  const IndexedScene indexed = index_scene(scene);
  const Oracle oracle(scene);
  const SceneRays rays(scene);
  const auto zbuffer = make_renderer("zbuffer", indexed);
  const VisibleSet all = VisibleSet::all(scene.objects().size());
  std::vector<View> views;
  for (int i = 0; i < 5; ++i) {
    const double turn = 0.4 + 1.3 * i;
    View view = look_along({1.5 + 2 * i, 0.5, 1.5}, {std::cos(turn), 0, std::sin(turn)});
    if (map.at(1 + 2 * i, 1) != 0) continue;
    view.width = 640;
    view.height = 400;
    view.near = 1e-3;
    views.push_back(view);
  }
  Counters counters;
  std::vector<Contender> contenders{
      {"column_cast, textures", [&](const View& v, Frame& f) { column_cast(map, v, {}, f, counters); }, {}},
      {"column_cast, ids and depth",
       [&](const View& v, Frame& f) { column_cast(map, v, {.correct_fisheye = true, .textured = false}, f, counters); },
       {}},
      {"rays, Embree packets", [&](const View& v, Frame& f) { oracle.draw(v, f); }, {}},
      {"rays, one by one",
       [&](const View& v, Frame& f) {
         f.clear(v.width, v.height);
         for (int y = 0; y < v.height; ++y)
           for (int x = 0; x < v.width; ++x) {
             const PixelRay p = pixel_ray(v, x + 0.5, y + 0.5);
             SceneRayHit hit;
             if (rays.nearest({p.origin, p.direction, p.t_near, p.t_far}, hit)) f.object[f.index(x, y)] = hit.object;
           }
       },
       {}},
      {"zbuffer", [&](const View& v, Frame& f) { zbuffer->draw(v, all, f, counters); }, {}}};
  for (const View& view : views) {
    Frame truth, frame;
    oracle.draw(view, truth);
    for (Contender& c : contenders) {
      c.draw(view, frame);
      if (agrees(frame, truth)) continue;
      std::fprintf(stderr, "bench_column_cast: %s gives another picture (%s)\n", c.name, describe(view).c_str());
      return 1;
    }
  }
  Frame frame;
  for (int round = 0; round < 9; ++round)
    for (Contender& c : contenders) {
      const double start = cpu_seconds();
      for (const View& view : views) c.draw(view, frame);
      c.seconds.push_back((cpu_seconds() - start) / static_cast<double>(views.size()));
    }
  const auto median = [](std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return v[v.size() / 2];
  };
  const double base = median(contenders[0].seconds);
  std::printf("%d x %d cells, 640 x 400 pixels, %zu views, one thread\n", map.width, map.depth, views.size());
  for (const Contender& c : contenders)
    std::printf("%-28s %8.3f ms per frame  %7.2fx column_cast\n", c.name, 1e3 * median(c.seconds),
                median(c.seconds) / base);
  return 0;
}
