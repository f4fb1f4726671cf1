// Views: matrices against GLM's, rays against matrices, frusta against rays, and the errors.
#include "sightline/scene/view.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "properties.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void expect_near(const glm::dmat4& a, const glm::dmat4& b, double tolerance = 1e-12) {
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) EXPECT_NEAR(a[c][r], b[c][r], tolerance) << "column " << c << " row " << r;
}

View sample_view() {
  View view = look_along({3, 4, 5}, {1, -0.5, 2});
  view.width = 640;
  view.height = 360;
  view.fov_y = 0.9;
  view.near = 0.25;
  view.far = 300;
  return view;
}

TEST(View, MatricesAreThoseOfOpenGL) {
  View view = sample_view();
  expect_near(view_matrix(view), glm::lookAt(view.eye, view.eye + glm::dvec3(1, -0.5, 2), glm::dvec3(0, 1, 0)));
  expect_near(projection_matrix(view), glm::perspective(0.9, 640.0 / 360.0, 0.25, 300.0));
  expect_near(view_projection(view), projection_matrix(view) * view_matrix(view));
  view.far = infinity;
  expect_near(projection_matrix(view), glm::infinitePerspective(0.9, 640.0 / 360.0, 0.25));
}

TEST(View, OrthographicMatrixIsThatOfOpenGL) {
  View view = sample_view();
  view.projection = Projection::orthographic;
  view.span_y = 18;
  expect_near(projection_matrix(view), glm::ortho(-16.0, 16.0, -9.0, 9.0, 0.25, 300.0));
}

TEST(View, LookAlongLooksAlongAndKeepsUpUp) {
  const View view = look_along({1, 2, 3}, {0, 0, -7});
  EXPECT_EQ(view.eye, glm::dvec3(1, 2, 3));
  EXPECT_NEAR(glm::length(view_direction(view) - glm::dvec3(0, 0, -1)), 0, 1e-12);
  EXPECT_NEAR(glm::length(view.orientation * glm::dvec3(0, 1, 0) - glm::dvec3(0, 1, 0)), 0, 1e-12);
}

TEST(View, LookAlongUpIsStillAView) {
  for (const glm::dvec3& up : {glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1)})
    for (const double sign : {1.0, -1.0}) {
      const View view = look_along({0, 0, 0}, sign * up, up);
      EXPECT_NO_THROW(check_view(view));
      EXPECT_NEAR(glm::length(view_direction(view) - sign * up), 0, 1e-12);
    }
}

TEST(View, LookAlongNothingIsAnError) {
  EXPECT_THROW(look_along({0, 0, 0}, {0, 0, 0}), InputError);
  EXPECT_THROW(look_along({0, 0, 0}, {infinity, 0, 0}), InputError);
  EXPECT_THROW(look_along({0, 0, 0}, {std::nan(""), 0, 1}), InputError);
}

/// A compiler that drops a rounding lets eye and geometry part; volatile so that this rounding stays, at least.
TEST(View, EyeIsAFloat) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 eye = 1000.0 * random.direction();
    const View view = look_along(eye, random.direction());
    for (int axis = 0; axis < 3; ++axis) {
      const volatile float rounded = static_cast<float>(eye[axis]);
      EXPECT_EQ(view.eye[axis], static_cast<double>(rounded)) << "axis " << axis;
    }
  }
}

TEST(View, FirstPixelIsTopLeft) {
  View view = look_along({0, 0, 0}, {0, 0, -1});
  const PixelRay ray = pixel_ray(view, 0.5, 0.5);
  EXPECT_LT(ray.direction.x, 0.0);
  EXPECT_GT(ray.direction.y, 0.0);
  EXPECT_DOUBLE_EQ(ray.direction.z, -1.0);
}

TEST(View, CheckAcceptsTheLimits) {
  View view;
  EXPECT_NO_THROW(check_view(view));
  view.far = infinity;
  EXPECT_NO_THROW(check_view(view));
  view.width = view.height = 1;
  EXPECT_NO_THROW(check_view(view));
  view.width = view.height = 16384;
  EXPECT_NO_THROW(check_view(view));
  view.near = smallest_distance;
  EXPECT_NO_THROW(check_view(view));
  view.near = 0.5 * smallest_distance;  // clipped triangles lose their digits: renderers drew other pixels than rays
  EXPECT_THROW(check_view(view), InputError);
}

TEST(View, CheckNamesWhatIsWrong) {
  struct Case {
    const char* what;
    std::function<void(View&)> spoil;
  };
  const double nan = std::nan("");
  const std::vector<Case> cases{
      {"eye", [&](View& v) { v.eye.y = nan; }},
      {"eye", [&](View& v) { v.eye.x = infinity; }},
      {"orientation", [&](View& v) { v.orientation = {nan, 0, 0, 0}; }},
      {"orientation", [&](View& v) { v.orientation = {0, 0, 0, 0}; }},
      {"orientation", [&](View& v) { v.orientation = {2, 0, 0, 0}; }},
      {"field of view", [&](View& v) { v.fov_y = 0; }},
      {"field of view", [&](View& v) { v.fov_y = -1; }},
      {"field of view", [&](View& v) { v.fov_y = 3.1415926535897932; }},
      {"field of view", [&](View& v) { v.fov_y = nan; }},
      {"near plane", [&](View& v) { v.near = 0; }},
      {"near plane",
       [&](View& v) {
         v.near = 1e16;
         v.far = 1e17;
       }},
      {"eye of the view is farther", [&](View& v) { v.eye.x = 1e16; }},
      {"near plane",
       [&](View& v) {
         v.projection = Projection::orthographic;
         v.near = -1;
       }},
      {"height of an orthographic view",
       [&](View& v) {
         v.projection = Projection::orthographic;
         v.span_y = 1e16;
       }},
      {"near plane", [&](View& v) { v.near = nan; }},
      {"near plane", [&](View& v) { v.near = v.far = infinity; }},
      {"far plane", [&](View& v) { v.far = v.near; }},
      {"far plane", [&](View& v) { v.far = nan; }},
      {"viewport", [&](View& v) { v.width = 0; }},
      {"viewport", [&](View& v) { v.height = -5; }},
      {"viewport", [&](View& v) { v.width = 16385; }},
  };
  for (const Case& c : cases) {
    View view;
    c.spoil(view);
    try {
      check_view(view);
      ADD_FAILURE() << "accepted a bad " << c.what;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(c.what), std::string::npos) << error.what();
    }
  }
}

TEST(View, CheckKnowsOrthographicViews) {
  View view;
  view.projection = Projection::orthographic;
  view.fov_y = 0;  // not used
  EXPECT_NO_THROW(check_view(view));
  view.far = infinity;
  EXPECT_THROW(check_view(view), InputError);
  view.far = 10;
  view.span_y = smallest_distance;
  EXPECT_NO_THROW(check_view(view));
  view.span_y = 1e-35;  // pixels per metre overflow a float: occlusion_masked lost what fills the view
  EXPECT_THROW(check_view(view), InputError);
  view.span_y = 0;
  EXPECT_THROW(check_view(view), InputError);
  view.span_y = std::nan("");
  EXPECT_THROW(check_view(view), InputError);
}

View random_view(double reach) {
  View view;
  view.eye = properties::point(reach);
  view.orientation = properties::rotation();
  view.projection = *rc::gen::element(Projection::perspective, Projection::orthographic);
  view.fov_y = properties::number(0.02, 3.0);
  view.span_y = properties::number(0.1, 100.0);
  view.near = properties::number(0.01, 2.0);
  view.far = view.near + properties::number(0.5, 1000.0);
  view.width = *rc::gen::inRange(1, 2000);
  view.height = *rc::gen::inRange(1, 2000);
  return view;
}

RC_GTEST_PROP(ViewProperty, RaysRunThroughTheirPixels, ()) {
  const View view = random_view(100);
  const double x = properties::number(0, view.width), y = properties::number(0, view.height);
  const PixelRay ray = pixel_ray(view, x, y);
  RC_ASSERT(std::abs(glm::dot(ray.direction, view_direction(view)) - 1.0) < 1e-9);
  const glm::dmat4 clip = view_projection(view);
  for (const double s : {0.0, 0.3, 1.0}) {
    const glm::dvec4 p =
        clip * glm::dvec4(ray.origin + (ray.t_near + s * (ray.t_far - ray.t_near)) * ray.direction, 1.0);
    RC_ASSERT(std::abs((p.x / p.w + 1) / 2 * view.width - x) < 1e-6 * view.width);
    RC_ASSERT(std::abs((1 - p.y / p.w) / 2 * view.height - y) < 1e-6 * view.height);
    if (s == 0.0) RC_ASSERT(std::abs(p.z / p.w + 1.0) < 1e-7);
    if (s == 1.0) RC_ASSERT(std::abs(p.z / p.w - 1.0) < 1e-7);
  }
}

RC_GTEST_PROP(ViewProperty, FrustumHoldsEveryRayOfTheImage, ()) {
  const double reach = *rc::gen::element(10.0, 1e5);
  const View view = random_view(reach);
  const Frustum frustum = view_frustum(view, 1.8 * reach + 4000.0);
  for (int i = 0; i < 20; ++i) {
    const PixelRay ray = pixel_ray(view, properties::number(0, view.width), properties::number(0, view.height));
    const glm::dvec3 p = ray.origin + properties::number(ray.t_near, ray.t_far) * ray.direction;
    const Aabb box{glm::vec3(p) - 1e-3f, glm::vec3(p) + 1e-3f};
    RC_ASSERT(classify(frustum, box) != Containment::outside);
  }
}

RC_GTEST_PROP(ViewProperty, FrustumEndsAtTheImage, ()) {
  const View view = random_view(10);
  const Frustum frustum = view_frustum(view, 2000);
  // Two pixels beyond each side of the image, away from the eye: outside by more than the slack of these coordinates.
  const double depth = view.near + 0.5 * (view.far - view.near);
  const double pixel = view.projection == Projection::perspective ? 2 * depth * std::tan(view.fov_y / 2) / view.height
                                                                  : view.span_y / view.height;
  RC_PRE(pixel * std::cos(view.fov_y / 2) > 0.01);
  for (const glm::dvec2& at : {glm::dvec2(-2, view.height / 2.0), glm::dvec2(view.width + 2, view.height / 2.0),
                               glm::dvec2(view.width / 2.0, -2), glm::dvec2(view.width / 2.0, view.height + 2)}) {
    const PixelRay ray = pixel_ray(view, at.x, at.y);
    const glm::vec3 p(ray.origin + depth * ray.direction);
    if (view.width > 50 && view.height > 50) RC_ASSERT(classify(frustum, Aabb{p, p}) == Containment::outside);
  }
}

TEST(View, DescribesItselfAsOptions) {
  const std::string text = describe(sample_view());
  for (const char* part : {"--eye 3,4,5", "--look ", "--fov 51.566", "--size 640x360", "--near 0.25", "--far 300"})
    EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(View, LooksAlongDirectionsOfAnyLength) {
  for (const double length : {1e-300, 1.0, 1e300}) {
    const glm::dvec3 d = view_direction(look_along({0, 0, 0}, {length, 0, length}));
    EXPECT_NEAR(d.x, std::sqrt(0.5), 1e-12);
    EXPECT_NEAR(d.z, std::sqrt(0.5), 1e-12);
  }
}

TEST(View, FrustumBoundsHoldEveryPointOfTheFrustum) {
  Random random(12);
  for (int round = 0; round < 200; ++round) {
    View view = look_along({random.range(-50, 50), random.range(-5, 5), random.range(-50, 50)}, random.direction());
    view.fov_y = random.range(0.1, 2.5);
    view.far = round % 5 == 0 ? std::numeric_limits<double>::infinity() : random.range(1, 500);
    if (round % 3 == 0 && round % 5 != 0) {
      view.projection = Projection::orthographic;
      view.span_y = random.range(0.1, 100);
    }
    const Aabb bounds = frustum_bounds(view);
    for (int i = 0; i < 50; ++i) {
      const PixelRay ray = pixel_ray(view, random.range(0, view.width), random.range(0, view.height));
      const double t = random.range(ray.t_near, std::min(ray.t_far, 1e4));
      EXPECT_TRUE(bounds.contains(glm::vec3(ray.origin + t * ray.direction))) << describe(view);
    }
  }
}

}  // namespace
}  // namespace sightline
