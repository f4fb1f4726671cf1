// Recursive rays: light and shadow, mirrors, glass that lets the ray go on (E22), refraction by Snell's law.
#include "sightline/surface/whitted.hpp"

#include <gtest/gtest.h>

#include "agreement/cases.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/scene_rays.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/generate/shapes.hpp"

namespace sightline {
namespace {

View facing(int size = 33) {
  View view = look_along({0, 0, 10}, {0, 0, -1});
  view.width = view.height = size;
  view.fov_y = 0.2;
  return view;
}

/// The middle pixel, linear light.
glm::vec3 middle(const Scene& scene, const WhittedConfig& config, const View& view) {
  Frame frame;
  Counters counters;
  make_whitted(scene, config)->draw(view, VisibleSet::all(scene.objects().size()), frame, counters);
  const std::uint32_t c = frame.colour[frame.index(view.width / 2, view.height / 2)];
  glm::vec3 result;
  for (int i = 0; i < 3; ++i) result[i] = std::pow(static_cast<float>((c >> (8 * i)) & 255u) / 255.0f, 2.2f);
  return result;
}

/// Squares across the view at these heights.
Scene squares(const std::vector<float>& heights, float half = 3) {
  SceneBuilder builder;
  for (const float z : heights)
    builder.add_object(builder.add_mesh(cases::quad({-half, -half, z}, {2 * half, 0, 0}, {0, 2 * half, 0})),
                       identity_affine());
  return builder.build();
}

/// A surface that shows this colour whatever the light.
WhittedMaterial plain(const glm::vec3& colour) {
  WhittedMaterial material;
  material.colour = colour;
  material.ambient = 1;
  material.diffuse = 0;
  material.highlight = 0;
  return material;
}

void expect_near(const glm::vec3& a, const glm::vec3& b) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 0.012) << i;
}

TEST(Whitted, TransparentSurfacesLetTheRayGoOn) {  // 13.02 with E22: the slide stops, which hides what lies behind
  const Scene scene = squares({0, 1, 2});
  WhittedConfig config;
  config.materials = {plain({0, 0, 1}), plain({0, 1, 0}), plain({1, 0, 0})};
  expect_near(middle(scene, config, facing()), {1, 0, 0});  // opaque: its colour, stop
  config.materials[2].transmit = 0.75f;
  expect_near(middle(scene, config, facing()), {0.25f, 0.75f, 0});
  config.materials[1].transmit = 0.5f;
  expect_near(middle(scene, config, facing()), {0.25f, 0.375f, 0.375f});
  config.materials[0].transmit = 1;
  config.sky = {0, 0, 0};
  expect_near(middle(scene, config, facing()), {0.25f, 0.375f, 0});
}

TEST(Whitted, ShadowsAndTheirGlass) {
  SceneBuilder builder;  // a floor seen from above, something between it and the light, out of the eye's way
  builder.add_object(builder.add_mesh(cases::quad({-3, -3, 0}, {6, 0, 0}, {0, 6, 0})), identity_affine());
  builder.add_object(builder.add_mesh(cases::quad({4, -2, 5}, {2, 0, 0}, {0, 4, 0})), identity_affine());
  const Scene scene = builder.build();
  WhittedConfig config;
  config.lights = {{{1, 0, 1}, true, glm::vec3(1)}};
  WhittedMaterial matt;
  matt.colour = glm::vec3(1);
  matt.ambient = 0.1f;
  matt.diffuse = 0.8f;
  matt.highlight = 0;
  config.materials = {matt, matt};
  const float lit = 0.1f + 0.8f * std::sqrt(0.5f);
  expect_near(middle(scene, config, facing()), glm::vec3(0.1f));
  config.materials[1].transmit = 0.5f;
  expect_near(middle(scene, config, facing()), glm::vec3(0.5f * (0.1f + lit)));
  config.materials[1] = matt;
  config.shadows = false;
  expect_near(middle(scene, config, facing()), glm::vec3(lit));
  config.shadows = true;
  config.lights = {{{4, 0, 4}, false, glm::vec3(1)}};  // a lamp before the obstacle
  expect_near(middle(scene, config, facing()), glm::vec3(lit));
}

TEST(Whitted, MirrorsShowWhatLiesThere) {  // 13.03
  SceneBuilder builder;
  const float r = 1.0f;
  builder.add_object(builder.add_mesh(cases::quad({-r, -r, r}, {2 * r, 0, -2 * r}, {0, 2 * r, 0})), identity_affine());
  builder.add_object(builder.add_mesh(cases::quad({8, -9, -9}, {0, 18, 0}, {0, 0, 18})), identity_affine());
  const Scene scene = builder.build();  // a mirror at 45 degrees, a red wall to the right of it
  WhittedConfig config;
  config.sky = {0, 0, 1};
  config.materials = {plain({0, 1, 0}), plain({1, 0, 0})};
  expect_near(middle(scene, config, facing()), {0, 1, 0});
  config.materials[0].reflect = 1;
  expect_near(middle(scene, config, facing()), {1, 0, 0});
  config.materials[0].reflect = 0.4f;
  expect_near(middle(scene, config, facing()), {0.4f, 0.6f, 0});
  config.materials[0].reflect = 1;
  config.materials[1].reflect = 1;  // the wall mirrors back into the mirror: depth ends it
  config.depth = 0;
  expect_near(middle(scene, config, facing()), {0, 0, 1});
}

TEST(Whitted, RefractionFollowsSnell) {
  // A slab tilted by 45 degrees displaces the ray; behind it a ramp of stripes tells where the ray arrives.
  constexpr double index = 1.5, thickness = 1.0;
  const double in = std::asin(std::sin(M_PI / 4) / index);
  const double shift = thickness * std::sin(M_PI / 4 - in) / std::cos(in);
  for (const bool refracted : {false, true}) {
    SceneBuilder builder;
    Mesh slab = make_box({-3, -3, -0.5f}, {3, 3, 0.5f});
    const glm::dmat3 turn = glm::mat3_cast(glm::angleAxis(M_PI / 4, glm::dvec3(0, 1, 0)));
    builder.add_object(builder.add_mesh(slab), {turn[0], turn[1], turn[2], glm::vec3(0)});
    const double arrives = refracted ? -shift : 0.0;  // the slab is turned so that the ray leaves towards -x
    const auto stripe = [&](double x0, double x1) {
      builder.add_object(builder.add_mesh(cases::quad({static_cast<float>(x0), -9, -6},
                                                      {static_cast<float>(x1 - x0), 0, 0}, {0, 18, 0})),
                         identity_affine());
    };
    stripe(arrives - 0.02, arrives + 0.02);
    stripe(-9, arrives - 0.02);
    stripe(arrives + 0.02, 9);
    const Scene scene = builder.build();
    WhittedConfig config;
    config.materials = {plain({0, 0, 0}), plain({1, 0, 0}), plain({0, 1, 0}), plain({0, 0, 1})};
    config.materials[0].transmit = 1;
    config.materials[0].index = refracted ? static_cast<float>(index) : 1.0f;
    View view = facing();
    view.fov_y = 0.01;
    const glm::vec3 seen = middle(scene, config, view);
    EXPECT_GT(seen.x, 0.9f) << "refracted " << refracted << ": green is left of the stripe, blue right: " << seen.y
                            << " " << seen.z;
  }
}

TEST(Whitted, SameForAnyNumberOfThreads) {
  const Scene scene = generate_scene("soup", {.objects = 80});
  View view = cases::hard_views(scene, 4, 2)[3];
  const IndexedScene indexed = index_scene(scene);
  Frame frames[2];
  for (int i = 0; i < 2; ++i) {
    const ThreadLimit limit(i == 0 ? 1 : 4);
    Counters counters;
    make_renderer("whitted:reflect=0.3", indexed)
        ->draw(view, VisibleSet::all(scene.objects().size()), frames[i], counters);
    EXPECT_GE(counters.queries, frames[i].object.size());
  }
  EXPECT_EQ(frames[0].colour, frames[1].colour);
  EXPECT_EQ(frames[0].depth, frames[1].depth);
}

TEST(SceneRays, DegenerateRaysAreAnswered) {  // E23: parallel rays, hits behind the eye, no direction
  const Scene scene = squares({0});
  const SceneRays rays(scene);
  SceneRayHit hit;
  EXPECT_TRUE(rays.nearest({{0.3, 0.1, 5}, {0, 0, -1}, 0, 100}, hit));
  EXPECT_EQ(hit.t, 5.0);
  EXPECT_TRUE(rays.nearest({{0.3, 0.1, 5}, {0, 0, -10}, 0, 100}, hit));
  EXPECT_EQ(hit.t, 0.5) << "the direction need not have unit length";
  EXPECT_FALSE(rays.nearest({{0.3, 0.1, 5}, {0, 0, 1}, 0, 100}, hit)) << "behind the eye";
  EXPECT_FALSE(rays.nearest({{0.3, 0.1, 5}, {1, 0, 0}, 0, 100}, hit)) << "parallel";
  EXPECT_FALSE(rays.nearest({{-9, 0.1, 0}, {1, 0, 0}, 0, 100}, hit)) << "within the plane";
  EXPECT_FALSE(rays.nearest({{0.3, 0.1, 5}, {0, 0, 0}, 0, 100}, hit));
  EXPECT_FALSE(rays.nearest({{0.3, NAN, 5}, {0, 0, -1}, 0, 100}, hit));
  EXPECT_FALSE(rays.nearest({{0.3, 0.1, 5}, {0, INFINITY, -1}, 0, 100}, hit));
  EXPECT_FALSE(rays.nearest({{0.3, 0.1, 5}, {0, 0, -1}, 0, 4.9}, hit));
  EXPECT_TRUE(rays.nearest({{0, 0, 5}, {0, 0, -1}, 0, 5}, hit)) << "on the diagonal both triangles share, end included";
  EXPECT_EQ(hit.triangle, 0u);
  EXPECT_FALSE(SceneRays(SceneBuilder().build()).nearest({{0, 0, 5}, {0, 0, -1}, 0, 5}, hit));
}

}  // namespace
}  // namespace sightline
