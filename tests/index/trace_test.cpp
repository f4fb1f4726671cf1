// Every tracing structure against brute force, bit by bit, on soups that make them go wrong, and with rays that do.
// So many lines because all structures are put through the same soups and rays.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>

#include "sightline/geometry/frustum.hpp"
#include "sightline/index/bvh8.hpp"
#include "sightline/index/bvh_builders.hpp"
#include "sightline/index/kdtree.hpp"
#include "sightline/index/tracer.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/scene_soup.hpp"

namespace sightline {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();

struct Case {
  std::string name;
  TriangleSoup soup;
};

void add(TriangleSoup& soup, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  soup.corners.insert(soup.corners.end(), {a, b, c});
}

glm::vec3 point_in(const Aabb& box, Random& random) {
  return {random.range(box.lo.x, box.hi.x), random.range(box.lo.y, box.hi.y), random.range(box.lo.z, box.hi.z)};
}

/// n x n squares in the plane y = height, corners on whole numbers: rays along it, through edges, through corners.
TriangleSoup sheet(int n, float height) {
  TriangleSoup soup;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const glm::vec3 o(i, height, j);
      add(soup, o, o + glm::vec3(1, 0, 0), o + glm::vec3(1, 0, 1));
      add(soup, o, o + glm::vec3(1, 0, 1), o + glm::vec3(0, 0, 1));
    }
  return soup;
}

std::vector<Case> cases() {
  std::vector<Case> all;
  Random random(11);
  all.push_back({"empty", {}});
  TriangleSoup one;
  add(one, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  all.push_back({"one", one});
  TriangleSoup points;
  for (int i = 0; i < 40; ++i) add(points, {1, 2, 3}, {1, 2, 3}, {1, 2, 3});
  all.push_back({"points at one place", points});
  all.push_back({"sheet", sheet(12, 0)});
  TriangleSoup layers;
  for (int k = 0; k < 6; ++k) {
    const TriangleSoup s = sheet(6, static_cast<float>(k / 2));  // each layer twice: ties
    layers.corners.insert(layers.corners.end(), s.corners.begin(), s.corners.end());
  }
  all.push_back({"layers twice", layers});
  TriangleSoup fan;  // all share one point (E26)
  for (int i = 0; i < 200; ++i) add(fan, {0, 0, 0}, glm::vec3(random.direction()), glm::vec3(random.direction()));
  all.push_back({"fan", fan});
  TriangleSoup slivers;
  for (int i = 0; i < 400; ++i) {
    const glm::vec3 a = 5.0f * glm::vec3(random.direction()), b = 5.0f * glm::vec3(random.direction());
    add(slivers, a, b, a + static_cast<float>(random.power_of_two_range(-24, -1)) * glm::vec3(random.direction()));
  }
  all.push_back({"slivers", slivers});
  TriangleSoup sizes;
  for (int i = 0; i < 600; ++i) {
    const auto size = static_cast<float>(random.power_of_two_range(-16, 4));
    const glm::vec3 o = 10.0f * glm::vec3(random.direction());
    add(sizes, o, o + size * glm::vec3(random.direction()), o + size * glm::vec3(random.direction()));
  }
  all.push_back({"all sizes", sizes});
  TriangleSoup far = sizes;
  for (glm::vec3& c : far.corners) c += glm::vec3(5000, -3000, 1000);
  all.push_back({"far from the origin", far});
  TriangleSoup huge;
  for (int i = 0; i < 100; ++i)
    add(huge, 1e9f * glm::vec3(random.direction()), 1e9f * glm::vec3(random.direction()),
        1e9f * glm::vec3(random.direction()));
  all.push_back({"huge", huge});
  TriangleSoup chain;  // each twice as far and as large: deep hierarchies
  for (int i = 0; i < 90; ++i) {
    const float s = std::ldexp(1.0f, i - 60);
    add(chain, {s, 0, 0}, {s, s, 0}, {s, 0, s});
  }
  all.push_back({"chain", chain});
  for (const char* kind : {"city", "soup", "building"}) {
    GenerateConfig config;
    config.objects = 60;
    all.push_back({kind, soup_of(generate_scene(kind, config))});
  }
  return all;
}

/// Rays that meet what they can only just meet: from and to vertices, along edges and planes, axis-parallel, zero
/// components, starting on surfaces, segments, from far away, reversed.
std::vector<Ray> rays_for(const TriangleSoup& soup, int count, std::uint64_t seed) {
  Random random(seed);
  Aabb bounds = bounds_of(soup);
  if (bounds.empty()) bounds = {{-1, -1, -1}, {1, 1, 1}};
  const float size = std::max({bounds.extent().x, bounds.extent().y, bounds.extent().z, 1e-3f});
  const Aabb wide{bounds.lo - 0.2f * size, bounds.hi + 0.2f * size};
  const auto corner = [&]() -> glm::vec3 {
    if (soup.corners.empty()) return point_in(wide, random);
    return soup.corners[random.below(static_cast<std::uint32_t>(soup.corners.size()))];
  };
  const auto on_edge = [&]() -> glm::vec3 {
    if (soup.corners.empty()) return point_in(wide, random);
    const glm::vec3* t = soup.triangle(random.below(static_cast<std::uint32_t>(soup.size())));
    return glm::mix(t[random.below(3)], t[random.below(3)], static_cast<float>(random.uniform()));
  };
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    Ray ray{point_in(wide, random), 0, glm::vec3(random.direction()), inf};
    const std::uint32_t kind = random.below(12);
    if (kind == 1) ray.direction = corner() - ray.origin;
    if (kind == 2) ray.direction = on_edge() - ray.origin;
    if (kind == 3) ray.origin = corner();
    if (kind == 4) ray = segment_ray(corner(), corner(), default_clearance);
    if (kind == 5) ray = segment_ray(on_edge(), on_edge(), 0);
    if (kind == 6 || kind == 7) {
      ray.direction = {};
      ray.direction[static_cast<int>(random.below(3))] = random.chance(0.5) ? 1.0f : -1.0f;
      if (kind == 7) ray.origin = glm::round(ray.origin);
    }
    if (kind == 8) ray.direction[static_cast<int>(random.below(3))] = random.chance(0.5) ? 0.0f : -0.0f;
    if (kind == 9) {
      ray.origin = 1000.0f * size * ray.direction;
      ray.direction = on_edge() - ray.origin;
    }
    if (kind == 10) {
      const glm::vec3 target = corner();
      ray.origin = target + glm::vec3(size, 0, 0) * static_cast<float>(random.range(-1, 1));
      ray.direction = target - ray.origin;
    }
    if (kind == 11) ray.direction *= static_cast<float>(random.power_of_two_range(-20, 20));
    rays.push_back(ray);
  }
  return rays;
}

std::string describe(const Ray& r) {
  char text[256];
  std::snprintf(text, sizeof text, "origin %.9g %.9g %.9g direction %.9g %.9g %.9g t %.9g %.9g", r.origin.x, r.origin.y,
                r.origin.z, r.direction.x, r.direction.y, r.direction.z, r.t_near, r.t_far);
  return text;
}

TEST(Trace, EveryStructureGivesTheHitsOfBruteForce) {
  for (const Case& c : cases()) {
    std::size_t hits = 0;
    const TraceSpace space = trace_space(bounds_of(c.soup));
    const std::vector<Ray> rays = rays_for(c.soup, c.soup.size() > 5000 ? 600 : 3000, 3);
    std::vector<RayHit> truth;
    TraceCounters counters;
    for (const Ray& ray : rays) truth.push_back(trace_brute(c.soup, space, ray, counters));
    for (const TracerKind& kind : tracer_kinds()) {
      const std::unique_ptr<Tracer> tracer = kind.make(c.soup);
      std::size_t differ = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const RayHit hit = tracer->nearest(rays[i], counters);
        hits += hit.found();
        const bool same = hit == truth[i] && tracer->any(rays[i], counters) == truth[i].found();
        if (!same && differ++ == 0)
          ADD_FAILURE() << kind.name << " on " << c.name << ": " << hit.triangle << " at " << hit.t << ", brute force "
                        << truth[i].triangle << " at " << truth[i].t << "; " << describe(rays[i]);
      }
      EXPECT_EQ(differ, 0u) << kind.name << " on " << c.name;
    }
    if (c.soup.size() > 100) {
      EXPECT_GT(hits, rays.size()) << c.name << ": the rays meet too little";
    }
  }
}

TEST(Trace, WhatIsNoRayMeetsNothing) {
  const TriangleSoup soup = sheet(10, 0), empty;  // tracers keep references
  const Ray good{{3.3f, 5, 3.4f}, 0, {0, -1, 0}, inf};
  std::vector<Ray> broken(9, good);
  broken[0].origin.x = nan;
  broken[1].direction.y = nan;
  broken[2].t_far = nan;
  broken[3].t_near = nan;
  broken[4].direction = {0, 0, 0};
  broken[5].t_near = 9;
  broken[5].t_far = 8;
  broken[6].origin.y = inf;
  broken[7].direction.y = -inf;
  broken[8].direction.y = -1e-38f;
  for (const TracerKind& kind : tracer_kinds()) {
    const std::unique_ptr<Tracer> tracer = kind.make(soup), nothing = kind.make(empty);
    TraceCounters counters;
    EXPECT_TRUE(tracer->nearest(good, counters).found()) << kind.name;
    EXPECT_FALSE(nothing->nearest(good, counters).found()) << kind.name;
    EXPECT_FALSE(nothing->any(good, counters)) << kind.name;
    EXPECT_TRUE(nothing->in_box({{-1, -1, -1}, {1, 1, 1}}).empty()) << kind.name;
    for (const Ray& ray : broken) {
      EXPECT_FALSE(tracer->nearest(ray, counters).found()) << kind.name << " " << describe(ray);
      EXPECT_FALSE(tracer->any(ray, counters)) << kind.name;
    }
  }
}

TEST(Trace, TiesGoToTheLowerPlace) {
  TriangleSoup soup;
  for (int i = 0; i < 100; ++i) add(soup, {-1, 0, -1}, {1, 0, -1}, {0, 0, 1});
  for (const TracerKind& kind : tracer_kinds()) {
    TraceCounters counters;
    EXPECT_EQ(kind.make(soup)->nearest({{0, 2, 0}, 0, {0.01f, -1, 0}, inf}, counters).triangle, 0u) << kind.name;
  }
}

TEST(Trace, NothingBehindTheEyeOrBeyondTheEnd) {
  const TriangleSoup soup = sheet(10, 0);
  for (const TracerKind& kind : tracer_kinds()) {
    const std::unique_ptr<Tracer> tracer = kind.make(soup);
    TraceCounters counters;
    EXPECT_FALSE(tracer->any({{3.3f, -2, 3.4f}, 0, {0, -1, 0}, inf}, counters)) << kind.name;
    EXPECT_FALSE(tracer->any({{3.3f, 2, 3.4f}, 0, {0, -1, 0}, 1.9f}, counters)) << kind.name;
    EXPECT_FALSE(tracer->any({{3.3f, 2, 3.4f}, 2.1f, {0, -1, 0}, inf}, counters)) << kind.name;
    EXPECT_TRUE(tracer->any(segment_ray({3.3f, 2, 3.4f}, {3.3f, -2, 3.4f}, 0), counters)) << kind.name;
    EXPECT_FALSE(tracer->any(segment_ray({3.3f, 0, 3.4f}, {3.3f, 2, 3.4f}, default_clearance), counters))
        << kind.name << ": the segment starts on the sheet";
    EXPECT_TRUE(tracer->any(segment_ray({3.3f, 0, 3.4f}, {3.3f, 2, 3.4f}, 0), counters)) << kind.name;
  }
}

TEST(Trace, EndsNextToAHitAreDecidedAsByBruteForce) {
  for (const Case& c : cases()) {
    const TraceSpace space = trace_space(bounds_of(c.soup));
    const Bvh8 tree = build_bvh8(c.soup);
    TraceCounters counters;
    for (const Ray& ray : rays_for(c.soup, 200, 12)) {
      const float t = trace_brute(c.soup, space, ray, counters).t;
      for (const float end : {std::nextafter(t, -inf), t, std::nextafter(t, inf)}) {
        for (const bool is_far : {false, true}) {
          Ray cut = ray;
          (is_far ? cut.t_far : cut.t_near) = end;
          const RayHit hit = trace_brute(c.soup, space, cut, counters);
          ASSERT_EQ(trace_nearest(tree, cut), hit) << c.name << " " << describe(cut);
          ASSERT_EQ(trace_any(tree, cut), hit.found()) << c.name << " " << describe(cut);
        }
      }
    }
  }
}

TEST(Trace, QueriesAgree) {
  for (const Case& c : cases()) {
    if (c.soup.size() == 0) continue;
    Random random(8);
    const Aabb bounds = bounds_of(c.soup);
    std::vector<std::unique_ptr<Tracer>> tracers;
    for (const TracerKind& kind : tracer_kinds()) tracers.push_back(kind.make(c.soup));
    for (int i = 0; i < 12; ++i) {
      Aabb box;
      box.extend(point_in(bounds, random));
      box.extend(i % 3 == 0 ? c.soup.corners[random.below(static_cast<std::uint32_t>(c.soup.corners.size()))]
                            : point_in(bounds, random));
      const glm::dmat4 lens(1.2, 0, 0, 0, 0, 1.5, 0, 0, 0, 0, -1.02, -1, 0, 0, -0.2, 0);
      glm::dmat4 place(1.0);
      place[3] = glm::dvec4(-glm::dvec3(point_in(bounds, random)), 1);
      const Frustum frustum = frustum_of(lens * place, reach(bounds) * 2.0);
      const auto in_box = tracers.back()->in_box(box), in_frustum = tracers.back()->in_frustum(frustum);
      for (std::size_t t = 0; t < tracers.size(); ++t) {
        EXPECT_EQ(tracers[t]->in_box(box), in_box) << tracer_kinds()[t].name << " on " << c.name;
        EXPECT_EQ(tracers[t]->in_frustum(frustum), in_frustum) << tracer_kinds()[t].name << " on " << c.name;
      }
    }
  }
}

TEST(Trace, EverySimdTargetAndTheScalarWalkGiveTheSameHits) {
  GenerateConfig config;
  config.objects = 60;
  const TriangleSoup soup = soup_of(generate_scene("city", config));
  const Bvh8 tree = build_bvh8(soup);
  const std::vector<Ray> rays = rays_for(soup, 4000, 5);
  std::vector<RayHit> scalar;
  TraceCounters counters;
  for (const Ray& ray : rays) scalar.push_back(trace_nearest_scalar(tree, ray, counters));
  int targets = 0;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().DeInit();
    ++targets;
    const Bvh8 again = build_bvh8(soup);
    EXPECT_EQ(again.triangles, tree.triangles) << hwy::TargetName(target) << ": another tree";
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const RayHit hit = trace_nearest(tree, rays[i], counters);
      ASSERT_EQ(hit, scalar[i]) << hwy::TargetName(target) << " " << describe(rays[i]);
      ASSERT_EQ(trace_any(tree, rays[i]), hit.found()) << hwy::TargetName(target) << " " << describe(rays[i]);
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
  EXPECT_GE(targets, 2);
}

/// Segments with the ends of such rays, and some that are no segments.
std::vector<Segment> segments_for(const TriangleSoup& soup, int count, std::uint64_t seed) {
  std::vector<Segment> segments;
  for (const Ray& ray : rays_for(soup, count, seed)) segments.push_back({ray.origin, ray.origin + ray.direction});
  for (std::size_t i = 0; i < segments.size(); i += 50) segments[i].b = segments[i].a;
  for (std::size_t i = 25; i < segments.size(); i += 50) segments[i].a.y = i % 4 == 1 ? nan : inf;
  return segments;
}

TEST(Trace, SegmentsTogetherAreAnsweredAsOneByOne) {
  for (const Case& c : cases()) {
    const Bvh8 tree = build_bvh8(c.soup);
    for (const int count : {0, 1, 2, 7, 8, 9, 17, 2000, -2000}) {
      std::vector<Segment> segments = segments_for(c.soup, std::abs(count), 8);
      const glm::vec3 from = count < 0 ? segments[0].a : glm::vec3(0), to = count < 0 ? segments[1].b : glm::vec3(0);
      if (count < 0)  // alike: what stops one often stops the next
        for (Segment& s : segments) s = {glm::mix(from, s.a, 0.02f), glm::mix(to, s.b, 0.02f)};
      for (const float clearance : {default_clearance, 0.0f, -0.5f, 0.5f, 0.6f, nan}) {
        std::vector<std::uint8_t> visible(segments.size(), 7);
        segments_visible(tree, segments, visible, clearance);
        TraceCounters counters;
        for (std::size_t i = 0; i < segments.size(); ++i) {
          const Ray ray = segment_ray(segments[i].a, segments[i].b, clearance);
          const bool free = !trace_nearest_scalar(tree, ray, counters).found();
          ASSERT_EQ(segment_visible(tree, segments[i].a, segments[i].b, clearance), free)
              << c.name << " " << describe(ray);
          ASSERT_EQ(visible[i], free ? 1 : 0) << c.name << " " << describe(ray);
        }
      }
    }
  }
}

TEST(Trace, RepeatedTestsFindTheSame) {
  GenerateConfig config;
  config.objects = 30;
  const TriangleSoup soup = soup_of(generate_scene("city", config));
  for (const TracerKind& kind : tracer_kinds()) {
    const std::unique_ptr<Tracer> tracer = kind.make(soup);
    for (const Ray& ray : rays_for(soup, 200, 7)) {
      std::vector<std::uint32_t> tested;
      TraceCounters counters;
      counters.tested = &tested;
      const RayHit hit = tracer->nearest(ray, counters);
      EXPECT_EQ(tracer->retest(ray, tested), hit) << kind.name;
    }
  }
}

TEST(Trace, IdsNameObjectAndTriangle) {
  GenerateConfig config;
  config.objects = 30;
  const Scene scene = generate_scene("city", config);
  const TriangleSoup soup = soup_of(scene);
  std::uint32_t place = 0;
  for (ObjectId id = 0; id < scene.objects().size(); ++id)
    for (std::uint32_t t = 0; t < scene.mesh_of(id).triangles.size(); ++t, ++place) {
      ASSERT_EQ(soup.ids(place).object, id);
      ASSERT_EQ(soup.ids(place).triangle, t);
    }
  EXPECT_EQ(place, soup.size());
}

}  // namespace
}  // namespace sightline
