// Projected areas: the slides' estimate and its errors (E51), the exact ellipse, silhouettes, and bounds of what is
// inside; the frustum as a solid.
#include "sightline/scene/screen_area.hpp"

#include <gtest/gtest.h>

#include "sightline/scene/frustum_shape.hpp"
#include "sightline/scene/generate/random.hpp"

namespace sightline {
namespace {

/// Share of the image's pixels whose rays hit the sphere, counted.
double counted_area(const View& view, const Sphere& sphere) {
  double pixels = 0;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const PixelRay ray = pixel_ray(view, x + 0.5, y + 0.5);
      const glm::dvec3 to = glm::dvec3(sphere.centre) - ray.origin, d = glm::normalize(ray.direction);
      const double along = glm::dot(to, d), away = glm::dot(to, to) - along * along;
      if (along > 0 && away < static_cast<double>(sphere.radius) * static_cast<double>(sphere.radius)) ++pixels;
    }
  return pixels;
}

TEST(ScreenArea, EllipseIsExact) {
  View view = look_along({1, 2, 3}, {0.2, 0.1, -1});
  view.width = 800;
  view.height = 600;
  view.fov_y = 1.2;
  for (const auto& [x, y] : {std::pair{400.0, 300.0}, std::pair{600.0, 200.0}, std::pair{150.0, 450.0}}) {
    const PixelRay ray = pixel_ray(view, x, y);
    const Sphere sphere{glm::vec3(ray.origin + 10.0 * ray.direction), 1.2f};
    EXPECT_NEAR(ellipse_area(view, sphere), counted_area(view, sphere), 0.006 * counted_area(view, sphere));
    EXPECT_LT(slide_area(view, sphere), ellipse_area(view, sphere));  // E51: underestimates
  }
  view.projection = Projection::orthographic;
  view.span_y = 12;
  const Sphere sphere{glm::vec3(view.eye + 20.0 * view_direction(view)), 1.2f};
  EXPECT_NEAR(ellipse_area(view, sphere), counted_area(view, sphere), 0.006 * counted_area(view, sphere));
}

/// 26.03 with E51: d = v . (c - e), r^ = r n / d in near-plane units, times (H / (2 n tan(fov / 2)))^2 in pixels; on
/// the axis the exact radius is r n / sqrt(d^2 - r^2); invalid for d <= r.
TEST(ScreenArea, SlidesEstimateAndItsUnits) {
  View view = look_along({0, 0, 0}, {0, 0, -1});
  view.near = 0.5;
  const double d = 10, r = 2, n = view.near, r_hat = r * n / d, pi = 3.14159265358979;
  const double to_pixels = view.height / (2 * n * std::tan(view.fov_y / 2));
  const Sphere sphere{{0, 0, -10}, 2};
  EXPECT_NEAR(slide_area(view, sphere), pi * r_hat * r_hat * to_pixels * to_pixels, 1e-3);
  const double exact = r * n / std::sqrt(d * d - r * r);
  EXPECT_NEAR(ellipse_area(view, sphere), pi * exact * exact * to_pixels * to_pixels, 1e-3);
  EXPECT_TRUE(std::isinf(slide_area(view, {{0, 0, -1}, 2})));
  EXPECT_TRUE(std::isinf(ellipse_area(view, {{0, 0, -1}, 2})));
  EXPECT_TRUE(std::isinf(ellipse_area(view, {{0, 0, 5}, 2})));
  EXPECT_EQ(ellipse_area(view, {{0, 0, -5}, -1}), 0.0);
}

TEST(ScreenArea, SilhouetteOfABox) {
  View view = look_along({0, 0, 0}, {0, 0, -1});
  view.width = view.height = 100;
  view.fov_y = std::acos(0.0);  // 50 pixels per unit of x / depth
  const Aabb box{{-1, -1, -12}, {1, 1, -10}};
  EXPECT_NEAR(screen_area_bound(view, box), 100.0, 1e-6);  // its near face, 2 / 10 * 50 = 10 pixels wide
  EXPECT_EQ(screen_area_bound(view, Aabb{{-1, -1, -12}, {1, 1, 1}}), 10000.0);  // reaches behind the eye: all
  EXPECT_EQ(screen_area_bound(view, Aabb{}), 0.0);
}

/// Every bound is at least the area that the points' hull covers, and for round things the tighter volume is tighter.
TEST(ScreenArea, BoundsHoldWhatIsInside) {
  Random random(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<glm::vec3> points;
    const glm::dvec3 place = random.range(3, 20) * random.direction();
    for (int i = 0; i < 30; ++i) points.emplace_back(place + random.range(0, 2) * random.direction());
    View view = look_along(glm::vec3(random.direction()), place);
    view.fov_y = random.range(0.3, 2);
    if (round % 3 == 0) view.projection = Projection::orthographic;
    const ConvexHull hull = convex_hull(points);
    const double truth = std::min(static_cast<double>(view.width) * view.height, silhouette_area(view, points));
    Aabb box;
    for (const glm::vec3& p : points) box.extend(p);
    for (const double bound :
         {screen_area_bound(view, hull), screen_area_bound(view, smallest_sphere(points)), screen_area_bound(view, box),
          screen_area_bound(view, pca_box(points)), screen_area_bound(view, make_kdop(points, 14)),
          screen_area_bound(view, make_kdop(points, 26))})
      EXPECT_GE(bound, truth * (1 - 1e-5) - 1e-6);
  }
}

/// 20.08: F = C + f d, P = F +- H/2 v +- W/2 u; 20.15: sphere and box around the frustum.
TEST(FrustumShape, CornersAndMetaBounds) {
  Random random(6);
  for (int round = 0; round < 60; ++round) {
    View view = look_along(random.range(0, 50) * random.direction(), random.direction());
    view.fov_y = random.range(0.2, 2);
    view.far = random.range(1, 100);
    if (round % 3 == 0) view.projection = Projection::orthographic;
    if (round % 5 == 1 && round % 3 != 0) view.far = std::numeric_limits<double>::infinity();
    const auto corners = frustum_corners(view, 500);
    const Sphere sphere = frustum_sphere(view, 500);
    const Aabb box = frustum_box(view, 500);
    for (std::size_t i = 0; i < 8; ++i) {
      const glm::dvec4 q = view_projection(view) * glm::dvec4(corners[i], 1.0);
      EXPECT_NEAR(q.x / q.w, (i & 1) != 0 ? 1 : -1, 1e-6);
      EXPECT_NEAR(q.y / q.w, (i & 2) != 0 ? 1 : -1, 1e-6);
      if (std::isfinite(view.far)) {
        EXPECT_NEAR(q.z / q.w, i >= 4 ? 1 : -1, 1e-6);
      }
      EXPECT_LE(glm::distance(corners[i], glm::dvec3(sphere.centre)), static_cast<double>(sphere.radius));
      EXPECT_TRUE(box.contains(glm::vec3(corners[i])));
    }
  }
}

}  // namespace
}  // namespace sightline
