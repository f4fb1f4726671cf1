// bench_bvh [boxes]: the bounding volume hierarchy. Contenders: the builder that scenes use, with
// fewer and more bins, its peers, and refitting after every box moved. The measure of quality is the surface area
// heuristic's cost per query (lower is better). CPU time of one thread, medians; that each box is found where it should
// be is checked before anything is timed.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <vector>

#include "sightline/index/bvh.hpp"
#include "sightline/index/bvh_builders.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/generate/random.hpp"

namespace {

using namespace sightline;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::vector<Aabb> random_boxes(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 centre(random.range(-1000, 1000), random.range(-1000, 1000), random.range(-100, 100));
    const glm::vec3 half(random.range(0.1, 3), random.range(0.1, 3), random.range(0.1, 3));
    boxes.push_back({centre - half, centre + half});
  }
  return boxes;
}

bool right(const Bvh& bvh, const std::vector<Aabb>& boxes) {
  std::vector<std::uint8_t> found(boxes.size(), 0);
  for (const BvhNode& node : bvh.nodes) {
    if (!node.leaf()) {
      if (!node.bounds.contains(bvh.nodes[node.first].bounds) ||
          !node.bounds.contains(bvh.nodes[node.first + 1].bounds))
        return false;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      if (found[bvh.items[i]]++ != 0 || !node.bounds.contains(boxes[bvh.items[i]])) return false;
    }
  }
  return std::all_of(found.begin(), found.end(), [](std::uint8_t f) { return f == 1; });
}

double cost(const Bvh& bvh) {
  double sum = 0;
  for (const BvhNode& node : bvh.nodes)
    sum += static_cast<double>(node.bounds.half_area()) * (node.leaf() ? node.count : 1.0);
  return sum / static_cast<double>(bvh.nodes[0].bounds.half_area());
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace

int main(int count, char** arguments) {
  const ThreadLimit one(1);
  const std::vector<Aabb> boxes =
      random_boxes(static_cast<std::size_t>(count > 1 ? std::atoi(arguments[1]) : 1000000), 1);
  std::vector<Aabb> moved = boxes;
  Random random(2);
  for (Aabb& box : moved) {
    const glm::vec3 step(random.range(-5, 5), random.range(-5, 5), random.range(-5, 5));
    box = {box.lo + step, box.hi + step};
  }
  struct Contender {
    const char* name;
    std::function<Bvh()> build;  // none: refit
    std::vector<double> seconds;
    double cost;
  };
  std::vector<Contender> contenders{{"build_bvh", [&] { return build_bvh(boxes); }, {}, 0},
                                    {"build_bvh, 8 bins", [&] { return build_bvh(boxes, {.bins = 8}); }, {}, 0},
                                    {"build_bvh, 32 bins", [&] { return build_bvh(boxes, {.bins = 32}); }, {}, 0},
                                    {"build_bvh, whole", [&] { return build_bvh(boxes, {.grouped = false}); }, {}, 0},
                                    {"linear", [&] { return build_bvh_linear(boxes); }, {}, 0},
                                    {"median", [&] { return build_bvh_median(boxes); }, {}, 0},
                                    {"refit", {}, {}, 0}};
  Bvh kept = build_bvh(boxes);
  for (int round = 0; round < 5; ++round)
    for (Contender& c : contenders) {
      const double start = cpu_seconds();
      Bvh built;
      if (c.build)
        built = c.build();
      else
        refit(kept, moved);
      c.seconds.push_back(cpu_seconds() - start);
      if (round > 0) continue;
      if (!right(c.build ? built : kept, c.build ? boxes : moved)) {
        std::fprintf(stderr, "bench_bvh: %s gives a wrong tree\n", c.name);
        return 1;
      }
      c.cost = cost(c.build ? built : kept);
    }
  std::printf("%zu boxes, one thread; wanted: 3 M boxes/s\n", boxes.size());
  for (const Contender& c : contenders)
    std::printf("%-20s %9.1f ms   %7.2f M boxes/s   cost %6.1f   %5.2fx the time of build_bvh\n", c.name,
                1e3 * median(c.seconds), 1e-6 * static_cast<double>(boxes.size()) / median(c.seconds), c.cost,
                median(c.seconds) / median(contenders[0].seconds));
  return 0;
}
