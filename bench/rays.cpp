// bench_rays [SCENE.glb | KIND TRIANGLES]: rays against one scene on one core, our structures and Embree interleaved,
// same rays (camera, diffuse bounce, random), results compared ray by ray first; then segment visibility, builds and
// memory. Default: a generated city of a million triangles. Exits 1 if a hit is wrong, before anything is timed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "embree_rays.hpp"
#include "sightline/index/bvh8.hpp"
#include "sightline/index/bvh_builders.hpp"
#include "sightline/index/tracer.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/camera_path.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/load.hpp"
#include "sightline/scene/scene_soup.hpp"
#include "sightline/scene/view.hpp"

namespace {

using namespace sightline;

constexpr int rounds = 5;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct RaySet {
  std::string name;
  std::vector<Ray> rays;
};

std::vector<Ray> camera_rays(const Scene& scene) {
  std::vector<Ray> rays;
  PathConfig config;
  config.frames = 4;
  for (const View& view : generate_path(scene, config).views)
    for (int y = 0; y < 360; ++y)
      for (int x = 0; x < 640; ++x) {
        View small = view;
        small.width = 640;
        small.height = 360;
        const PixelRay r = pixel_ray(small, x + 0.5, y + 0.5);
        rays.push_back({glm::vec3(r.origin), 0.0f, glm::vec3(r.direction), std::numeric_limits<float>::infinity()});
      }
  return rays;
}

/// From the hits of camera rays on, in cosine-distributed directions on the side that the ray came from.
std::vector<Ray> bounce_rays(const TriangleSoup& soup, const std::vector<Ray>& rays, const std::vector<RayHit>& hits) {
  Random random(3);
  std::vector<Ray> result;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!hits[i].found()) continue;
    const glm::vec3* c = soup.triangle(hits[i].triangle);
    glm::dvec3 normal = glm::cross(glm::dvec3(c[1] - c[0]), glm::dvec3(c[2] - c[0]));
    if (!(glm::length(normal) > 0.0)) continue;
    normal = glm::normalize(normal) * (glm::dot(normal, glm::dvec3(rays[i].direction)) > 0.0 ? -1.0 : 1.0);
    const glm::dvec3 direction = normal * 1.0001 + random.direction();
    const glm::dvec3 from = point_at(rays[i], static_cast<double>(hits[i].t)) + 1e-3 * normal;
    result.push_back(
        {glm::vec3(from), 0.0f, glm::vec3(glm::normalize(direction)), std::numeric_limits<float>::infinity()});
  }
  return result;
}

glm::vec3 random_point(const Aabb& box, Random& random) {
  return {random.range(box.lo.x, box.hi.x), random.range(box.lo.y, box.hi.y), random.range(box.lo.z, box.hi.z)};
}

std::vector<Ray> random_rays(const Aabb& bounds, std::size_t count) {
  Random random(4);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i)
    rays.push_back(
        {random_point(bounds, random), 0.0f, glm::vec3(random.direction()), std::numeric_limits<float>::infinity()});
  return rays;
}

using TraceAll = std::function<void(const std::vector<Ray>&, std::vector<RayHit>&)>;
struct Contender {
  std::string name;
  TraceAll trace;
};

template <class One>
TraceAll batch(One one) {
  return [one](const std::vector<Ray>& rays, std::vector<RayHit>& hits) {
    for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = one(rays[i]);
  };
}

struct Difference {
  std::size_t same = 0, ties = 0, wrong = 0;
};

/// Ties: another triangle at the same distance up to rounding.
Difference compare(const std::vector<RayHit>& a, const std::vector<RayHit>& b) {
  Difference d;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].triangle == b[i].triangle) {
      ++d.same;
      continue;
    }
    const double ta = static_cast<double>(a[i].t), tb = static_cast<double>(b[i].t);
    if (a[i].found() && b[i].found() && std::abs(ta - tb) <= 1e-4 * (1.0 + std::min(ta, tb)))
      ++d.ties;
    else
      ++d.wrong;
  }
  return d;
}

/// Times the contenders whose hits are those of Embree's robust mode, the first one; says which are not. False if one
/// of ours differs from the others of ours.
bool time_rays(const std::vector<Contender>& all, const RaySet& set) {
  constexpr std::size_t ours = 1;  // the first of ours
  std::vector<std::vector<RayHit>> hits(all.size(), std::vector<RayHit>(set.rays.size()));
  std::vector<std::size_t> right;
  bool good = true;
  for (std::size_t c = 0; c < all.size(); ++c) {
    all[c].trace(set.rays, hits[c]);
    const bool is_ours = all[c].name.find("embree") == std::string::npos;
    const Difference embree = compare(hits[c], hits[0]), own = compare(hits[c], hits[ours]);
    std::printf("  %-14s vs %s: %zu same, %zu ties, %zu other; vs %s: %zu differ\n", all[c].name.c_str(),
                all[0].name.c_str(), embree.same, embree.ties, embree.wrong, all[ours].name.c_str(),
                own.ties + own.wrong);
    if (embree.wrong * 20000 <= set.rays.size())
      right.push_back(c);
    else
      std::printf("  %-14s is not timed: its answers are wrong\n", all[c].name.c_str());
    if (is_ours) good &= own.ties + own.wrong == 0 && right.back() == c;
  }
  if (!good) return false;
  std::vector<std::vector<double>> seconds(all.size());
  for (int r = 0; r < rounds; ++r)
    for (const std::size_t c : right) {
      const double start = cpu_seconds();
      all[c].trace(set.rays, hits[c]);
      seconds[c].push_back(cpu_seconds() - start);
    }
  for (const std::size_t c : right) {
    std::vector<double> ratios;
    for (std::size_t r = 0; r < seconds[c].size(); ++r) ratios.push_back(seconds[0][r] / seconds[c][r]);
    std::printf("%-8s %-14s %7.3f M rays/s  %5.2f x %s\n", set.name.c_str(), all[c].name.c_str(),
                1e-6 * static_cast<double>(set.rays.size()) / median(seconds[c]), median(ratios), all[0].name.c_str());
  }
  return true;
}

/// Pairs of points: anywhere in the scene; and from surfaces to sixteen lights above it.
std::vector<Segment> random_segments(const Aabb& bounds, std::size_t count) {
  Random random(5);
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < count; ++i)
    segments.push_back({random_point(bounds, random), random_point(bounds, random)});
  return segments;
}

std::vector<Segment> light_segments(const Aabb& bounds, const std::vector<Ray>& rays) {
  Random random(6);
  std::vector<glm::vec3> lights;
  for (int i = 0; i < 16; ++i) {
    glm::vec3 p = random_point(bounds, random);
    p.y = bounds.lo.y + 0.9f * bounds.extent().y;
    lights.push_back(p);
  }
  std::vector<Segment> segments;
  for (const Ray& ray : rays) segments.push_back({ray.origin, lights[random.below(16)]});
  return segments;
}

bool time_segments(const char* name, const EmbreeRays& embree, const Bvh8& tree, const std::vector<Segment>& segments) {
  std::vector<std::uint8_t> truth(segments.size()), one(segments.size()), batched(segments.size());
  const std::function<void()> works[] = {
      [&] {
        for (std::size_t i = 0; i < segments.size(); ++i)
          truth[i] = embree.any(segment_ray(segments[i].a, segments[i].b, default_clearance)) ? 0 : 1;
      },
      [&] {
        for (std::size_t i = 0; i < segments.size(); ++i) one[i] = segment_visible(tree, segments[i].a, segments[i].b);
      },
      [&] { segments_visible(tree, segments, batched); }};
  std::vector<double> seconds[3];
  for (int r = 0; r < rounds; ++r)
    for (int w = 0; w < 3; ++w) {
      const double start = cpu_seconds();
      works[w]();
      seconds[w].push_back(cpu_seconds() - start);
    }
  std::size_t other = 0, seen = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    other += truth[i] != one[i];
    seen += one[i];
    if (one[i] != batched[i]) {
      std::printf("segment %zu: batched and single answers differ\n", i);
      return false;
    }
  }
  const char* names[] = {"rtcOccluded1", "bvh8 one by one", "bvh8 batched"};
  for (int w = 0; w < 3; ++w) {
    std::vector<double> ratios;
    for (std::size_t r = 0; r < rounds; ++r) ratios.push_back(seconds[0][r] / seconds[w][r]);
    std::printf("%-8s %-15s %7.3f M segments/s  %5.2f x rtcOccluded1 (robust)\n", name, names[w],
                1e-6 * static_cast<double>(segments.size()) / median(seconds[w]), median(ratios));
  }
  std::printf("  %zu of %zu visible; %zu answers differ from embree's\n", seen, segments.size(), other);
  return other * 10000 <= segments.size();
}

double seconds_of(const std::function<void()>& work) {
  std::vector<double> seconds;
  for (int i = 0; i < 3; ++i) {
    const double start = cpu_seconds();
    work();
    seconds.push_back(cpu_seconds() - start);
  }
  return median(seconds);
}

void time_builds(const TriangleSoup& soup) {
  const double millions = 1e-6 * static_cast<double>(soup.size());
  const BvhConfig config{.max_leaf_size = static_cast<int>(bvh8_leaf_limit), .grouped = false};
  std::vector<Aabb> boxes;
  const double measure = seconds_of([&] { boxes = bounds_of_triangles(soup); });
  std::printf("bounds of triangles: %.1f ns each\n", 1e3 * measure / millions);
  struct NamedBuilder {
    const char* name;
    Bvh (*build)(std::span<const Aabb>, const BvhConfig&);
  };
  constexpr NamedBuilder builders[] = {
      {"sah", build_bvh}, {"linear", build_bvh_linear}, {"extent", build_bvh_extent}, {"median", build_bvh_median}};
  for (const auto& [name, build] : builders) {
    Bvh bvh;
    Bvh8 wide;
    const double binary = seconds_of([&] { bvh = build(boxes, config); });
    const double widening = seconds_of([&] { wide = widen(bvh, soup); });
    std::printf("build %-8s %6.2f M triangles/s (binary), %6.2f with bounds and widening; %.1f bytes a triangle\n",
                name, millions / binary, millions / (measure + binary + widening),
                static_cast<double>(wide.bytes()) / static_cast<double>(soup.size()));
  }
}

int run(const Scene& scene) {
  const ThreadLimit one(1);
  const TriangleSoup soup = soup_of(scene);
  std::printf("%zu triangles\n", soup.size());
  EmbreeRays fast(soup, RTC_SCENE_FLAG_NONE, "threads=1"), robust(soup, RTC_SCENE_FLAG_ROBUST, "threads=1");
  fast.build();
  const double start = cpu_seconds();
  robust.build();
  std::printf("embree build %.2f M triangles/s\n", 1e-6 * static_cast<double>(soup.size()) / (cpu_seconds() - start));
  const std::vector<Aabb> boxes = bounds_of_triangles(soup);
  const BvhConfig config{.max_leaf_size = static_cast<int>(bvh8_leaf_limit), .grouped = false};
  const Bvh8 sah = build_bvh8(soup), linear = widen(build_bvh_linear(boxes, config), soup);
  const auto kdtree = find_tracer("kdtree")->make(soup), octree = find_tracer("octree")->make(soup),
             grid = find_tracer("grid")->make(soup);
  const auto peer = [](const char* name, const Tracer& tracer) {
    return Contender{name, [&tracer](const std::vector<Ray>& rays, std::vector<RayHit>& hits) {
                       TraceCounters work;
                       for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = tracer.nearest(rays[i], work);
                     }};
  };
  const std::vector<Contender> contenders{
      {"embree robust", batch([&](const Ray& r) { return robust.nearest(r); })},
      {"bvh8 sah", batch([&](const Ray& r) { return trace_nearest(sah, r); })},
      {"bvh8 linear", batch([&](const Ray& r) { return trace_nearest(linear, r); })},
      peer("kdtree", *kdtree),
      peer("octree", *octree),
      peer("grid", *grid),
      {"embree default", batch([&](const Ray& r) { return fast.nearest(r); })}};
  std::vector<RaySet> sets{{"camera", camera_rays(scene)}};
  std::vector<RayHit> first(sets[0].rays.size());
  contenders[1].trace(sets[0].rays, first);
  sets.push_back({"bounce", bounce_rays(soup, sets[0].rays, first)});
  sets.push_back({"random", random_rays(sah.space.bounds, 500000)});
  for (const RaySet& set : sets)
    if (!time_rays(contenders, set)) return 1;
  if (!time_segments("random", robust, sah, random_segments(sah.space.bounds, 500000)) ||
      !time_segments("lights", robust, sah, light_segments(sah.space.bounds, sets[1].rays)))
    return 1;
  time_builds(soup);
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // what is done is seen, also if the rest is cut off
  try {
    std::vector<std::string> words;  // without what is meant for Google Benchmark's programs
    for (int i = 1; i < count; ++i)
      if (arguments[i][0] != '-') words.emplace_back(arguments[i]);
    if (words.size() == 1) return run(load_scene(words[0]).scene);
    GenerateConfig config;
    config.objects = 5000;
    config.triangles = words.size() == 2 ? std::stoull(words[1]) : 1000000;
    return run(generate_scene(words.size() == 2 ? words[0] : "city", config));
  } catch (const InputError& error) {
    std::fprintf(stderr, "bench_rays: %s\n", error.what());
    return 3;
  }
}
