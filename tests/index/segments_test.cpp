// Segments in batches against brute force, one by one: random soups of few triangles, so that ends lie in vertices, on
// edges and faces, and every length of a batch has its turn.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "sightline/index/bvh8.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/generate/random.hpp"

namespace sightline {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();

/// Points within [-scale, scale]; on whole numbers of a coarse grid, if it is one.
struct Place {
  float scale;
  bool grid;
  glm::vec3 operator()(Random& random) const {
    glm::vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = random.range(-1.0f, 1.0f);
    return scale * (grid ? glm::round(3.0f * p) : p);
  }
};

TriangleSoup random_soup(std::uint32_t count, const Place& place, Random& random) {
  TriangleSoup soup;
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::vec3 a = place(random);
    const auto size = static_cast<float>(random.power_of_two_range(-8, 1));
    const glm::vec3 b = place.grid ? place(random) : a + size * place(random);
    const glm::vec3 c = place.grid ? place(random) : a + size * place(random);
    soup.corners.insert(soup.corners.end(), {a, random.chance(0.05) ? a : b, c});
  }
  return soup;
}

glm::vec3 random_end(const TriangleSoup& soup, const Place& place, Random& random) {
  const std::uint32_t kind = soup.size() == 0 ? 0 : random.below(8);
  if (kind == 0) return 2.5f * place(random);  // outside as well
  if (kind == 1) return place(random);
  if (kind == 2) return place(random) * static_cast<float>(random.power_of_two_range(-100, 0));
  const glm::vec3* t = soup.triangle(random.below(static_cast<std::uint32_t>(soup.size())));
  if (kind == 3) return t[random.below(3)];
  if (kind == 4) return glm::mix(t[0], t[random.below(3)], static_cast<float>(random.uniform()));
  glm::vec3 p = place(random);
  if (kind == 5) p[static_cast<int>(random.below(3))] = t[0].y;
  if (kind >= 6) p = glm::mix(t[0], glm::mix(t[1], t[2], random.range(0.0f, 1.0f)), random.range(0.0f, 1.0f));
  return p;
}

Segment random_segment(const TriangleSoup& soup, const Place& place, Random& random) {
  Segment s{random_end(soup, place, random), random_end(soup, place, random)};
  const auto axis = static_cast<int>(random.below(3));
  switch (random.below(20)) {
    case 0:
      s.b = s.a;
      break;
    case 1:
      s.a[axis] = nan;
      break;
    case 2:
      s.b[axis] = nan;
      break;
    case 3:
      s.a[axis] = inf;
      break;
    case 4:
      s.b[axis] = -inf;
      break;
    case 5:
      s.a *= 1e30f;
      break;
    case 6:
      s.b *= 1e20f;
      break;
    case 7:
      s.b[axis] = s.a[axis];
      break;
    case 8:
      (s.b = s.a)[axis] += place.scale;
      break;
    case 9:
      s.b = s.a + 1e-6f * (s.b - s.a);
      break;
    default:
      break;
  }
  return s;
}

TEST(Segments, EveryLengthOfABatchIsAnsweredAsByBruteForce) {
  constexpr float clearances[] = {
      default_clearance, 0.0f, default_clearance, 0.0f, -0.5f, 0.5f, 1.0f, -1e30f, inf, nan};
  std::size_t stopped = 0, free = 0;
  for (std::uint32_t round = 0; round < 71 * 14; ++round) {
    Random random(round);
    // From 1e-15 to 1e15 metres, now and then.
    const bool ordinary = random.chance(0.7);
    const Place place{ordinary ? 1.0f : static_cast<float>(random.power_of_two_range(-50, 48)), random.chance(0.4)};
    const TriangleSoup soup =
        random_soup(round % 29 == 0 ? 0 : 1 + random.below(round % 2 == 0 ? 12 : 300), place, random);
    const TraceSpace space = trace_space(bounds_of(soup));
    const Bvh8 tree = build_bvh8(soup);
    const float clearance = clearances[random.below(std::size(clearances))];
    std::vector<Segment> segments;
    std::vector<std::uint8_t> truth;
    TraceCounters counters;
    segments.reserve(round % 71);  // no more, so that a sanitizer sees what is read behind them
    for (std::uint32_t i = 0; i < round % 71; ++i) {
      const Segment s = random_segment(soup, place, random);
      const Ray ray = segment_ray(s.a, s.b, clearance);
      segments.push_back(s);
      truth.push_back(trace_brute(soup, space, ray, counters).found() ? 0 : 1);
      ++(truth.back() == 0 ? stopped : free);
      ASSERT_EQ(segment_visible(tree, s.a, s.b, clearance), truth.back() == 1) << "round " << round << ", " << i;
    }
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      hwy::SetSupportedTargetsForTest(target);
      hwy::GetChosenTarget().DeInit();
      const ThreadLimit limit(1 + static_cast<int>(round % 4));
      std::vector<std::uint8_t> visible(segments.size(), 7);
      segments_visible(tree, segments, visible, clearance);
      ASSERT_EQ(visible, truth) << hwy::TargetName(target) << ", round " << round;
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().DeInit();
  }
  EXPECT_GT(stopped, 5000u);
  EXPECT_GT(free, 5000u);
}

/// Alike: between two small places, so that what stopped one segment is tried first against the next.
TEST(Segments, BatchesOfSeveralBlocksAlikeAndUnlikeForAllThreadsAndTargets) {
  Random random(5);
  const Place place{1.0f, false};
  const TriangleSoup soup = random_soup(200, place, random);
  const Bvh8 tree = build_bvh8(soup);
  for (const bool alike : {false, true})
    for (const std::size_t count : {16383, 16384, 16385, 32769}) {
      const glm::vec3 from = place(random), to = place(random);
      std::vector<Segment> segments;
      std::vector<std::uint8_t> truth, visible(count, 7);
      for (std::size_t i = 0; i < count; ++i) {
        Segment s = random_segment(soup, place, random);
        if (alike) s = {from + 0.3f * s.a, to + 0.3f * s.b};
        segments.push_back(s);
        truth.push_back(segment_visible(tree, s.a, s.b) ? 1 : 0);
      }
      EXPECT_GT(std::count(truth.begin(), truth.end(), 0), 1000);
      EXPECT_GT(std::count(truth.begin(), truth.end(), 1), 1000);
      for (const int threads : {1, 3})
        for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
          const ThreadLimit limit(threads);
          hwy::SetSupportedTargetsForTest(target);
          hwy::GetChosenTarget().DeInit();
          segments_visible(tree, segments, visible);
          ASSERT_EQ(visible, truth) << count << ' ' << threads << ' ' << hwy::TargetName(target);
        }
      hwy::SetSupportedTargetsForTest(0);
      hwy::GetChosenTarget().DeInit();
    }
}

/// The parameter at which such a segment, along an axis, would meet the far bounds on another is more than a float
/// holds.
TEST(Segments, MinuteOnesInTheMiddleOfTheLargestScene) {
  TriangleSoup soup;
  for (const float z : {-1e15f, 0.0f, 1e15f})
    soup.corners.insert(soup.corners.end(), {{-1e15f, -1e15f, z}, {1e15f, -1e15f, z}, {0.0f, 1e15f, z}});
  const TraceSpace space = trace_space(bounds_of(soup));
  const Bvh8 tree = build_bvh8(soup);
  for (const float half : {1e-15f, 1e-14f, 1e-10f, 1e-3f, 1e3f, 1e14f})
    for (const float aside : {0.0f, 0.25f * half}) {
      const Segment segment{{0, 0, half}, {aside, aside, -half}};
      const Ray ray = segment_ray(segment.a, segment.b, default_clearance);
      TraceCounters counters;
      EXPECT_TRUE(trace_brute(soup, space, ray, counters).found()) << half;
      EXPECT_TRUE(trace_any(tree, ray)) << half;
      for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().DeInit();
        std::uint8_t visible = 7;
        segments_visible(tree, {&segment, 1}, {&visible, 1});
        EXPECT_EQ(visible, 0) << half << ' ' << hwy::TargetName(target);
      }
      hwy::SetSupportedTargetsForTest(0);
      hwy::GetChosenTarget().DeInit();
    }
}

TEST(Segments, MinuteDirectionsFromOutsideOfALargeScene) {
  for (const float size : {1e3f, 1e13f, 1e15f}) {
    TriangleSoup soup;
    for (const float x : {0.0f, 0.5f, 1.0f})
      soup.corners.insert(soup.corners.end(),
                          {size * glm::vec3(x, 0, 0), size * glm::vec3(x, 1, 0), size * glm::vec3(x, 0, 1)});
    const TraceSpace space = trace_space(bounds_of(soup));
    const Bvh8 tree = build_bvh8(soup);
    for (const glm::vec3& direction : {glm::vec3(1, 1, 1), glm::vec3(1, 0.9f, 0.8f), glm::vec3(1, 0, 0)})
      for (const float side : {-1.0f, 1.0f}) {
        const Ray ray{glm::vec3(size * (0.5f - 0.6f * side)), 0, side * 1e-15f * direction, inf};
        TraceCounters counters;
        const RayHit hit = trace_brute(soup, space, ray, counters);
        EXPECT_EQ(trace_nearest(tree, ray), hit) << size;
        EXPECT_EQ(trace_nearest_scalar(tree, ray, counters), hit) << size;
        EXPECT_EQ(trace_any(tree, ray), hit.found()) << size;
      }
  }
}

/// Eight boxes at one place in every node, all passed and nothing hit: stacks are as full as they get.
TEST(Segments, StacksHoldAllThatWaits) {
  TriangleSoup soup;
  for (int i = 0; i < 5000; ++i) soup.corners.insert(soup.corners.end(), 3, glm::vec3(1, 2, 3));
  for (const glm::vec3& far : {glm::vec3(0, 2, 0), glm::vec3(4, 2, 4)})
    soup.corners.insert(soup.corners.end(), {far, far + glm::vec3(0, 1, 0), far + glm::vec3(0, 0, 1)});
  const Bvh8 tree = build_bvh8(soup);
  std::vector<Segment> segments;
  for (int i = 0; i < 70; ++i)
    segments.push_back({{1, 2, 3}, glm::vec3(1, 2, 3) + glm::vec3(std::cos(i), 3, std::sin(i))});
  std::vector<std::uint8_t> visible(segments.size(), 7);
  segments_visible(tree, segments, visible);
  EXPECT_EQ(visible, std::vector<std::uint8_t>(segments.size(), 1));
}

}  // namespace
}  // namespace sightline
