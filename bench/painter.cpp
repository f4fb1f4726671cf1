// bench_painter: what painting in a sorted order costs and what it gets wrong (checklist 2.01-2.04, 2.21, 15.12). For
// generated scenes: share of pixels whose object is not the oracle's, by sort key, with cuts, and in the order of a BSP
// tree; triangles, parts, overdraw, and time per frame once the tree is built. CPU time of one thread.
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>

#include "sightline/oracle/oracle.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/camera_path.hpp"
#include "sightline/scene/generate/generate.hpp"

namespace {

using namespace sightline;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

int main() {
  const ThreadLimit one(1);
  bool exact_is_exact = true;
  for (const char* kind : {"city", "building", "forest", "soup"}) {
    const Scene scene = generate_scene(kind, {.objects = 300, .seed = 2});
    const IndexedScene indexed = index_scene(scene);
    const Oracle oracle(scene);
    PathConfig config;
    config.frames = 4;
    config.prototype.width = 320;
    config.prototype.height = 200;
    config.prototype.far = 4.0 * static_cast<double>(glm::length(scene.bounds().extent()));
    const std::vector<View> views = generate_path(scene, config).views;
    const VisibleSet all = VisibleSet::all(scene.objects().size());
    std::printf("%s: %llu triangles, %zu views of 320 x 200\n", kind,
                static_cast<unsigned long long>(scene.triangle_count()), views.size());
    for (const char* method : {"painter:key=farthest", "painter:key=centroid", "painter:key=nearest",
                               "painter:split=on", "painter_bsp", "painter_bsp:near_to_far=on", "zbuffer"}) {
      const auto renderer = make_renderer(method, indexed);
      Frame frame, truth;
      Counters warm_up, counters;
      const double before = cpu_seconds();
      renderer->draw(views[0], all, frame, warm_up);
      const double first = cpu_seconds() - before;
      std::size_t wrong = 0, pixels = 0;
      double seconds = 0;
      for (const View& view : views) {
        const double start = cpu_seconds();
        renderer->draw(view, all, frame, counters);
        seconds += cpu_seconds() - start;
        oracle.draw(view, truth);
        pixels += truth.object.size();
        for (std::size_t i = 0; i < truth.object.size(); ++i) wrong += frame.object[i] != truth.object[i] ? 1 : 0;
      }
      const double share = static_cast<double>(wrong) / static_cast<double>(pixels);
      std::printf(
          "  %-30s wrong %8.4f %%   parts drawn %8llu   pixels painted / image %6.2f   first %9.1f ms   "
          "frame %8.1f ms\n",
          method, 100 * share, static_cast<unsigned long long>(counters.triangles_filled / views.size()),
          static_cast<double>(counters.pixels_written) / static_cast<double>(pixels), 1e3 * first,
          1e3 * seconds / static_cast<double>(views.size()));
      // Edges and coplanar faces may differ, more than that is wrong.
      if (std::string(method).find("key") == std::string::npos && share > 0.005) exact_is_exact = false;
    }
  }
  if (!exact_is_exact) std::fprintf(stderr, "bench_painter: an exact method is wrong\n");
  return exact_is_exact ? 0 : 1;
}
