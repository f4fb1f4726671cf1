// The test that counts: the picture of every exact method is that of drawing everything, bit by bit, in colour, depth
// and id; along walks, after teleports, with the eye at, in and behind things, in any size, while objects move.
#include <cstdlib>

#include "agreement/cases.hpp"
#include "gl/compare.hpp"
#include "gl/registry.hpp"
#include "gl/with_context.hpp"
#include "sightline/scene/camera_path.hpp"

namespace sightline::gl {
namespace {

class Exactness : public WithContext {};

/// Every method, and settings of the ones that have many.
std::vector<std::string> contenders() {
  std::vector<std::string> all;
  for (const GlAlgorithm& algorithm : algorithms()) all.emplace_back(algorithm.row.name);
  for (const char* setting :
       {"gl_chc:hierarchy=off", "gl_chc:deterministic=off", "gl_chcpp:deterministic=off:batch=7",
        "gl_chcpp:batch=5:depth=3", "gl_chcpp:multiqueries=off:assumed=0", "gl_chcpp:value=slides:random=off:adapt=off",
        "gl_chcpp:sigma=0:open=3", "gl_chcpp:sigma=4:depth=5", "gl_stop_and_wait:hierarchy=off",
        "gl_conditional:wait=off:group=100", "gl_frustum:order=far", "gl_hzb:finer=0", "gl_draw_and_wait:first=0",
        "gl_overlap_free:largest=5"})
    all.emplace_back(setting);
  return all;
}

struct Contest {
  Contest(Context& context, const Scene& scene) : drawing(context, scene), comparison(drawing), names(contenders()) {
    for (const std::string& name : names) methods.push_back(make_method(name, drawing));
  }
  void frame(const std::string& scene, const View& view) {
    comparison.draw_all(view);
    for (std::size_t m = 0; m < methods.size(); ++m)
      EXPECT_EQ(comparison.differing_pixels(*methods[m], view), 0u)
          << names[m] << " on " << scene << ": " << describe(view);
  }
  SceneDrawing drawing;
  Comparison comparison;
  std::vector<std::string> names;
  std::vector<std::unique_ptr<Method>> methods;
};

View prototype(const Scene& scene, int width, int height) {
  View view;
  view.width = width;
  view.height = height;
  view.near = 0.05;
  view.far = 4.0 * static_cast<double>(glm::length(scene.bounds().extent()));
  return view;
}

TEST_F(Exactness, AlongWalks) {
  for (const char* kind : {"city", "building", "plant", "forest"}) {
    const Scene scene = generate_scene(kind, {.objects = 400, .triangles = 0, .seed = 3});
    Contest contest(*context(), scene);
    for (const View& view : generate_path(scene, {.frames = 20, .prototype = prototype(scene, 161, 91)}).views)
      contest.frame(kind, view);
  }
}

TEST_F(Exactness, WhereCamerasAreHard) {
  for (const cases::Case& c : cases::generated()) {
    if (c.scene.objects().size() > 1000) continue;
    Contest contest(*context(), c.scene);
    for (const View& view : cases::hard_views(c.scene, 8, 17, 96)) contest.frame(c.name, view);
  }
}

TEST_F(Exactness, AfterTeleportsAndAtSurfaces) {
  const Scene scene = generate_scene("city", {.objects = 500, .triangles = 0, .seed = 9});
  Contest contest(*context(), scene);
  for (const View& view : stress_path(scene, {.frames = 24, .prototype = prototype(scene, 128, 72)}).views)
    contest.frame("city under stress", view);
}

// Corners on a line, as T-junctions are closed: once they are snapped to a grid they cover pixels, with any depth.
TEST_F(Exactness, TrianglesWithoutAreaBehindAWall) {
  SceneBuilder builder;
  const MeshId wall = builder.add_mesh(cases::quad({-60, -40, 0}, {120, 0, 0}, {0, 80, 0}));
  builder.add_object(wall, cases::at({0, 0, -20}));
  Random random(5);
  const auto place = [&](float depth) { return glm::vec3(random.range(-30, 30), random.range(-20, 20), depth); };
  for (int i = 0; i < 60; ++i) {
    Mesh mesh;
    for (int t = 0; t < 40; ++t) {
      const glm::vec3 a = place(random.range(-45, -25)), b = place(random.range(-45, -25));
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.insert(mesh.positions.end(), {a, b, glm::mix(a, b, random.range(0.1, 0.9))});
      mesh.triangles.emplace_back(first, first + 1, first + 2);
    }
    builder.add_object(builder.add_mesh(mesh), identity_affine());
  }
  const Scene scene = builder.build();
  Contest contest(*context(), scene);
  for (int i = 0; i < 6; ++i) {
    View view = look_along({random.range(-1, 1), random.range(-1, 1), 0}, {random.range(-0.1, 0.1), 0, -1});
    view.width = 320;
    view.height = 180;
    contest.frame("triangles without area", view);
  }
}

TEST_F(Exactness, WhileThePictureChangesItsSize) {
  const Scene scene = generate_scene("building", {.objects = 300, .triangles = 0, .seed = 1});
  Contest contest(*context(), scene);
  constexpr int sizes[][2] = {{64, 64}, {1, 1}, {333, 7}, {2, 200}, {97, 101}, {64, 64}, {255, 129}};
  CameraPath path = generate_path(scene, {.frames = 14, .prototype = prototype(scene, 64, 64)});
  for (std::size_t i = 0; i < path.views.size(); ++i) {
    path.views[i].width = sizes[i % 7][0];
    path.views[i].height = sizes[i % 7][1];
    contest.frame("building", path.views[i]);
  }
}

TEST_F(Exactness, WhileObjectsMove) {
  const Scene scene = generate_scene("city", {.objects = 300, .triangles = 0, .seed = 6});
  Contest contest(*context(), scene);
  Random random(8);
  const CameraPath path = generate_path(scene, {.frames = 16, .prototype = prototype(scene, 128, 72)});
  for (const View& view : path.views) {
    for (int k = 0; k < 12; ++k) {
      const ObjectId id = random.below(static_cast<std::uint32_t>(scene.objects().size()));
      Affine transform = scene.objects()[id].transform;
      // Some go straight to where the eye looks: from hidden, or from outside, to the very front.
      const glm::dvec3 place = k == 0 ? view.eye + 6.0 * view_direction(view) : cases::point_in(scene.bounds(), random);
      transform[3] = glm::vec3(place);
      contest.drawing.move(id, transform);
    }
    contest.drawing.refit();
    contest.frame("city on the move", view);
  }
}

// The check itself must be able to fail.
TEST_F(Exactness, ALossIsSeen) {
  const Scene scene = generate_scene("city", {.objects = 300, .triangles = 0, .seed = 6});
  SceneDrawing drawing(*context(), scene);
  Comparison comparison(drawing);
  const CameraPath path = generate_path(scene, {.frames = 12, .prototype = prototype(scene, 160, 90)});
  std::uint64_t differing = 0;
  const auto lossy = make_method("gl_chcpp:threshold=400", drawing);
  EXPECT_TRUE(lossy->approximate());
  EXPECT_FALSE(make_method("gl_chcpp", drawing)->approximate());
  for (const View& view : path.views) {
    comparison.draw_all(view);
    differing += comparison.differing_pixels(*lossy, view);
  }
  EXPECT_GT(differing, 0u);
}

TEST_F(Exactness, AThresholdLosesLittle) {
  const Scene scene = generate_scene("city", {.objects = 800, .triangles = 0, .seed = 6});
  SceneDrawing drawing(*context(), scene);
  Comparison comparison(drawing);
  const CameraPath path = generate_path(scene, {.frames = 20, .prototype = prototype(scene, 160, 90)});
  const auto lossy = make_method("gl_chcpp:threshold=8", drawing);
  for (const View& view : path.views) {
    comparison.draw_all(view);
    EXPECT_LT(comparison.differing_pixels(*lossy, view), 160u * 90u / 10u);
  }
}

}  // namespace
}  // namespace sightline::gl
