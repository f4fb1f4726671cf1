// Surfaces that lie in sheets behind one another in the image: the contour of one must not take back what another
// covers, and nothing may be closed that is open.
#include <gtest/gtest.h>

#include "agreement/cases.hpp"
#include "sightline/raster/occlusion_buffer.hpp"

namespace sightline {
namespace {

/// A ribbon along a profile of (x, z), upright, cut so that every pixel of the views below holds edges.
Mesh ribbon(const std::vector<glm::vec2>& profile) {
  Mesh mesh;
  constexpr float step = 0.7f;
  constexpr std::uint32_t rows = 60;
  std::vector<glm::vec2> points;
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    const float length = glm::length(profile[i + 1] - profile[i]);
    const auto parts = static_cast<std::uint32_t>(std::max(1.0f, length / step));
    for (std::uint32_t k = 0; k < parts; ++k)
      points.push_back(glm::mix(profile[i], profile[i + 1], static_cast<float>(k) / static_cast<float>(parts)));
  }
  points.push_back(profile.back());
  for (const glm::vec2& p : points)
    for (std::uint32_t j = 0; j <= rows; ++j) mesh.positions.emplace_back(p.x, -21 + step * static_cast<float>(j), p.y);
  for (std::uint32_t i = 0; i + 1 < points.size(); ++i)
    for (std::uint32_t j = 0; j < rows; ++j) {
      const std::uint32_t a = i * (rows + 1) + j, b = a + rows + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  return mesh;
}

/// Pixels are one by one; the image's centre is the corner between columns 31 and 32.
View grid_view() {
  View view = look_along({0, 0, 0}, {0, 0, -1});
  view.width = 64;
  view.height = 36;
  view.projection = Projection::orthographic;
  view.span_y = 36;
  return view;
}

OcclusionBuffer drawn(const Mesh& mesh, const View& view, bool scalar = false) {
  OcclusionBuffer buffer(scalar);
  buffer.begin(view, view.width, view.height);
  buffer.add_occluder(make_occluder(mesh.positions, mesh.triangles), identity_affine());
  return buffer;
}

TEST(OcclusionSheets, AContourTakesNothingBackFromWhatLiesBeforeOrBehind) {
  const Mesh folded = ribbon({{-20, -5}, {10.3f, -5}, {-3.4f, -10}, {20, -10}});
  const OcclusionBuffer buffer = drawn(folded, grid_view());
  for (int y = 2; y < 34; ++y) {
    EXPECT_NEAR(buffer.hidden_beyond(28, y), 5.0f, 0.01f) << "the far sheet's contour lies here, " << y;
    EXPECT_NEAR(buffer.hidden_beyond(42, y), 10.0f, 0.01f) << "the near sheet's contour lies here, " << y;
  }
}

TEST(OcclusionSheets, AStepSeenAlongItsSideHidesNoGapBehindIt) {
  // The near part ends within column 32; a side that the view looks along leads to a far part, which ends there too.
  for (const float lean : {0.0f, 1e-6f, -1e-6f, 1e-4f, -1e-4f, 0.01f, -0.01f, 0.1f, -0.1f})
    for (const bool perspective : {false, true})
      for (const float far : {-5.5f, -10.0f, -40.0f}) {
        const float spread = perspective ? far / -5 : 1;
        const Mesh step = ribbon({{-20, -5}, {0.7f, -5}, {(0.7f + lean) * spread, far}, {0.9f * spread, far}});
        View view = grid_view();
        if (perspective) {
          view.projection = Projection::perspective;
          view.fov_y = 2 * std::atan(18.0 / 5);
        }
        const OcclusionBuffer buffer = drawn(step, view);
        for (int y = 2; y < 34; ++y) {
          EXPECT_NEAR(buffer.hidden_beyond(31, y), 5.0f, 0.01f);
          EXPECT_TRUE(std::isinf(buffer.hidden_beyond(32, y))) << lean << ' ' << far << ' ' << y;
        }
      }
}

/// A sheet crumpled at random, in one piece.
Mesh crumpled(Random& random, double size) {
  Mesh mesh;
  constexpr std::uint32_t n = 5;
  const double fold = random.range(0.2, 2.5), deep = random.chance(0.5) ? random.range(0.2, 2.5) : 8;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i)
      mesh.positions.emplace_back(size * (i - 2.5 + random.range(-fold, fold)),
                                  size * (j - 2.5 + random.range(-fold, fold)), -5 - 3 * random.range(0, deep));
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + n + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  if (random.chance(0.3)) std::swap(mesh.triangles[7].x, mesh.triangles[7].y);
  return mesh;
}

/// Distance along the view direction to the nearest triangle, by all of them.
double nearest_hit(const Mesh& mesh, const PixelRay& ray) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double along = glm::dot(normal, ray.direction);
    if (along == 0) continue;
    const double distance = glm::dot(normal, a - ray.origin) / along;
    const glm::dvec3 p = ray.origin + distance * ray.direction;
    const double slack = -1e-9 * glm::dot(normal, normal);
    if (glm::dot(glm::cross(b - a, p - a), normal) >= slack && glm::dot(glm::cross(c - b, p - b), normal) >= slack &&
        glm::dot(glm::cross(a - c, p - c), normal) >= slack && distance >= ray.t_near)
      nearest = std::min(nearest, distance);
  }
  return nearest;
}

TEST(OcclusionSheets, NoRayPassesWhatACrumpledSheetHides) {
  Random random(41);
  std::size_t hidden = 0, passed = 0;
  for (int round = 0; round < 400; ++round) {
    View view = grid_view();
    view.width = 20;
    view.height = 12;
    view.span_y = 12;
    view.near = round % 4 == 0 ? 6.0 : 0.1;
    if (round % 2 == 0) {
      view.projection = Projection::perspective;
      view.fov_y = 1.5;
    }
    const Mesh mesh = crumpled(random, random.range(0.3, 3));
    const OcclusionBuffer buffer = drawn(mesh, view), reference = drawn(mesh, view, true);
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x) {
        const float beyond = buffer.hidden_beyond(x, y);
        EXPECT_EQ(beyond, reference.hidden_beyond(x, y));
        if (std::isinf(beyond)) continue;
        ++hidden;
        for (int s = 0; s < 36; ++s) {
          const PixelRay ray = pixel_ray(view, x + 0.002 + 0.996 * (s % 6) / 5.0, y + 0.002 + 0.996 * (s / 6) / 5.0);
          const bool passes = nearest_hit(mesh, ray) > beyond * 1.0001;
          passed += passes ? 1 : 0;
          EXPECT_FALSE(passes) << "round " << round << ", pixel " << x << ' ' << y;
        }
      }
  }
  EXPECT_GT(hidden, 10000u) << "the test asks for nothing";
  EXPECT_EQ(passed, 0u);
}

}  // namespace
}  // namespace sightline
