// Which nodes share a query: the probability, both forms of the value, the greedy search.
#include "gl/multiquery.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sightline/scene/generate/random.hpp"

namespace sightline::gl {
namespace {

TEST(Multiquery, KeepProbabilityIsThatOfThePaper) {
  EXPECT_NEAR(keep_probability(0), 0.29, 1e-12);
  EXPECT_NEAR(keep_probability(1), 0.99 - 0.7 * std::exp(-1.0), 1e-12);
  EXPECT_NEAR(keep_probability(1000), 0.99, 1e-9);
  for (std::uint32_t t = 0; t < 50; ++t) EXPECT_GE(keep_probability(t + 1), keep_probability(t));
}

std::vector<MultiqueryCandidate> equal(std::size_t count, double keep, double triangles = 1.0) {
  return std::vector<MultiqueryCandidate>(count, {keep, triangles});
}

TEST(Multiquery, PaperValueOfOneNodeIsOne) {
  EXPECT_EQ(multiquery_value(equal(1, 0.3), 1, {}), 1.0);
  EXPECT_NEAR(multiquery_value(equal(4, 0.9), 4, {}), 4.0 / (1.0 + 4.0 * (1.0 - std::pow(0.9, 4))), 1e-12);
}

TEST(Multiquery, SlidesValueFollowsTheFormula) {
  const MultiqueryConfig config{ValueForm::slides, 0.5, 256};
  EXPECT_NEAR(multiquery_value(equal(3, 0.8, 10.0), 3, config), std::pow(0.8, 3) * 30.0 / 2.5, 1e-12);
}

TEST(Multiquery, LikelyHiddenNodesShareUnlikelyOnesStayAlone) {
  EXPECT_EQ(multiquery_size(equal(20, 0.29), {}), 1u);
  const std::size_t size = multiquery_size(equal(100, 0.99), {});
  EXPECT_GT(size, 5u);
  EXPECT_LT(size, 100u);
  EXPECT_EQ(multiquery_size(equal(100, 0.99), {ValueForm::paper, 0.1, 4}), 4u);
}

TEST(Multiquery, SlidesFormTakesTheBestOfAllPrefixes) {
  Random random(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<MultiqueryCandidate> list;
    for (std::uint32_t i = 0; i < 1 + random.below(40); ++i)
      list.push_back({random.range(0.3, 0.99), random.range(1.0, 1000.0)});
    const MultiqueryConfig config{ValueForm::slides, random.range(0.0, 2.0), 256};
    const std::size_t size = multiquery_size(list, config);
    for (std::size_t n = 1; n <= list.size(); ++n)
      EXPECT_LE(multiquery_value(list, n, config), multiquery_value(list, size, config) * (1 + 1e-12));
  }
}

TEST(Multiquery, PaperFormStopsWhereTheValueFalls) {
  Random random(6);
  for (int round = 0; round < 200; ++round) {
    std::vector<MultiqueryCandidate> list;
    for (std::uint32_t i = 0; i < 1 + random.below(40); ++i) list.push_back({random.range(0.3, 0.99), 1.0});
    std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.keep > b.keep; });
    const std::size_t size = multiquery_size(list, {});
    for (std::size_t n = 2; n <= size; ++n) EXPECT_GT(multiquery_value(list, n, {}), multiquery_value(list, n - 1, {}));
    if (size < list.size()) {
      EXPECT_LE(multiquery_value(list, size + 1, {}), multiquery_value(list, size, {}));
    }
  }
}

}  // namespace
}  // namespace sightline::gl
