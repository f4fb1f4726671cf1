// What OpenGL draws: the scene as the software z-buffer sees it, the same picture in any order, pictures of any size;
// and what happens where OpenGL is missing.
#include <algorithm>
#include <limits>

#include "agreement/cases.hpp"
#include "gl/compare.hpp"
#include "gl/registry.hpp"
#include "gl/with_context.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/generate/shapes.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline::gl {
namespace {

class Drawing : public WithContext {};

/// Share of the pixels that show another object, or the same one more than 1e-3 (relative) farther or nearer.
double disagreement(const Frame& a, const Frame& b) {
  std::size_t differing = 0;
  for (std::size_t i = 0; i < a.object.size(); ++i) {
    const bool near = a.object[i] == no_object || std::abs(a.depth[i] - b.depth[i]) <= 1e-3f * (a.depth[i] + 1.0f);
    differing += a.object[i] != b.object[i] && !(a.object[i] != no_object && b.object[i] != no_object && near) ? 1 : 0;
  }
  return static_cast<double>(differing) / static_cast<double>(a.object.size());
}

TEST_F(Drawing, ShowsWhatTheSoftwareRendererShows) {
  const Scene scene = generate_scene("city", {.objects = 300, .triangles = 0, .seed = 2});
  const IndexedScene indexed = index_scene(scene);
  SceneDrawing drawing(*context(), scene);
  Comparison comparison(drawing);
  const auto zbuffer = make_renderer("zbuffer", indexed);
  for (const View& view : cases::hard_views(scene, 24, 3, 200)) {
    Frame truth;
    Counters counters;
    zbuffer->draw(view, VisibleSet::all(scene.objects().size()), truth, counters);
    comparison.draw_all(view);
    ASSERT_EQ(comparison.reference().width, view.width);
    ASSERT_EQ(comparison.reference().colour.size(), truth.object.size());
    // Edges may fall on the other side of a pixel centre: OpenGL snaps vertices to a grid.
    if (truth.object.size() > 1000) {
      EXPECT_LT(disagreement(truth, comparison.reference()), 0.02) << describe(view);
    }
  }
}

// Back faces are left out where nobody can see them, and nowhere else: an open box, a mirrored solid, one turned inside
// out, and a solid with the eye in it or the near plane through it show the inside of their far wall.
TEST_F(Drawing, OnlySolidsSeenFromOutsideAreOneSided) {
  const Mesh box = make_box({-1, -1, -1}, {1, 1, 1});
  Mesh open = box, inverted = box;
  open.triangles.pop_back();
  for (glm::uvec3& t : inverted.triangles) std::swap(t.y, t.z);
  Affine mirrored = cases::at({0, 10, 0});
  mirrored[0] = -mirrored[0];
  SceneBuilder builder;
  const MeshId solid = builder.add_mesh(box);
  builder.add_object(solid, cases::at({0, 0, 0}));
  builder.add_object(builder.add_mesh(open), cases::at({10, 0, 0}));
  builder.add_object(builder.add_mesh(inverted), cases::at({20, 0, 0}));
  builder.add_object(solid, mirrored);
  const Scene scene = builder.build();
  SceneDrawing drawing(*context(), scene);
  Target target;
  const auto one_sided = [&](const glm::dvec3& eye) {
    View view = look_along(eye, {0, 0, -1});
    view.width = 64;
    view.height = 36;
    drawing.begin(view, target);
    std::vector<bool> answers;
    for (ObjectId id = 0; id < 4; ++id) answers.push_back(drawing.one_sided(id));
    return answers;
  };
  EXPECT_EQ(one_sided({0, 0, 5}), (std::vector<bool>{true, false, false, false}));
  EXPECT_EQ(one_sided({0, 0, 1.05}), std::vector<bool>(4, false));  // the near plane, 0.1 m off, opens it
  EXPECT_EQ(one_sided({0, 0, 0}), std::vector<bool>(4, false));

  // From inside, all four show their walls in every pixel.
  for (const glm::dvec3& eye : {glm::dvec3(0), glm::dvec3(10, 0, 0), glm::dvec3(20, 0, 0), glm::dvec3(0, 10, 0)}) {
    (void)one_sided(eye);
    const ObjectId ids[] = {0, 1, 2, 3};
    drawing.draw(ids);
    std::vector<std::uint32_t> seen;
    target.read_ids(seen);
    EXPECT_EQ(std::count(seen.begin(), seen.end(), no_object), 0) << eye.x << " " << eye.y;
  }
}

// A floor seen at 45 degrees, in all projections, level and rolled: 0.35 + 0.4 cos 45 + 0.25 of its colour everywhere.
TEST_F(Drawing, LightFollowsTheWayASurfaceFaces) {
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(cases::quad({-500, 0, -500}, {0, 0, 1000}, {1000, 0, 0})), identity_affine());
  const Scene scene = builder.build();
  SceneDrawing drawing(*context(), scene);
  const std::uint32_t white[] = {0xffffffffu};
  drawing.set_colours(white);
  Target target;
  const ObjectId floor = 0;
  for (const glm::dvec3& up : {glm::dvec3(0, 1, 0), glm::dvec3(1, 1, 0)})
    for (const auto& [projection, far] : {std::pair{Projection::perspective, 1000.0},
                                          std::pair{Projection::perspective, std::numeric_limits<double>::infinity()},
                                          std::pair{Projection::orthographic, 1000.0}}) {
      View view = look_along({0, 10, 10}, {0, -1, -1}, up);
      view.width = 64;
      view.height = 36;
      view.projection = projection;
      view.far = far;
      view.fov_y = 0.6;
      drawing.begin(view, target);
      drawing.draw({&floor, 1});
      Frame frame;
      target.read_back(view, frame);
      for (std::size_t i = 0; i < frame.object.size(); ++i) {
        ASSERT_EQ(frame.object[i], floor);
        ASSERT_NEAR(static_cast<int>(frame.colour[i] & 255u), 225, 1) << i << " " << describe(view);
      }
    }
}

TEST_F(Drawing, TheLowerIdWinsATieInAnyOrder) {
  const Scene scene = cases::degenerate_scene();  // has the same wall twice
  SceneDrawing drawing(*context(), scene);
  View view = look_along({0, 0, 2}, {0, 0, -1});
  view.width = 200;
  view.height = 120;
  std::vector<ObjectId> ids(scene.objects().size());
  for (ObjectId id = 0; id < ids.size(); ++id) ids[id] = id;
  Target target;
  Frame forward, backward;
  for (Frame* frame : {&forward, &backward}) {
    drawing.begin(view, target);
    drawing.draw(ids);
    drawing.resolve_ties(ids);
    target.read_back(view, *frame);
    std::reverse(ids.begin(), ids.end());
  }
  EXPECT_EQ(forward.object, backward.object);
  EXPECT_EQ(forward.colour, backward.colour);
  EXPECT_EQ(forward.depth, backward.depth);
  VisibleSet seen(ids.size());
  for (const ObjectId id : forward.object)
    if (id != no_object) seen.insert(id);
  EXPECT_TRUE(seen.contains(5));   // "wall"
  EXPECT_FALSE(seen.contains(6));  // "same wall again"
}

TEST_F(Drawing, AnEmptySceneIsAnEmptyPicture) {
  const Scene scene = SceneBuilder().build();
  SceneDrawing drawing(*context(), scene);
  Comparison comparison(drawing);
  View view;
  view.width = 5;
  view.height = 3;
  comparison.draw_all(view);
  for (const GlAlgorithm& algorithm : algorithms())
    EXPECT_EQ(comparison.differing_pixels(*make_method(algorithm.row.name, drawing), view), 0u) << algorithm.row.name;
}

TEST_F(Drawing, AMethodAsCullerAnswersWithWhatItDrew) {
  const Scene scene = generate_scene("building", {.objects = 300, .triangles = 0, .seed = 5});
  const auto drawing = std::make_shared<SceneDrawing>(*context(), scene);
  VisibleSet odd(scene.objects().size());
  for (ObjectId id = 1; id < scene.objects().size(); id += 2) odd.insert(id);
  for (const GlAlgorithm& algorithm : algorithms()) {
    MethodCuller culler(drawing, algorithm.row.name);
    for (const View& view : cases::hard_views(scene, 6, 2)) {
      VisibleSet visible;
      Counters counters;
      culler.cull(view, odd, visible, counters);
      EXPECT_TRUE(visible.subset_of(odd)) << algorithm.row.name;
      EXPECT_EQ(visible.universe(), odd.universe());
    }
  }
}

TEST_F(Drawing, UnknownMethodsAndParametersAreNamed) {
  const Scene scene = cases::gap_scene(0.1f);
  SceneDrawing drawing(*context(), scene);
  EXPECT_THROW((void)make_method("gl_magic", drawing), InputError);
  for (const GlAlgorithm& algorithm : algorithms())
    EXPECT_THROW((void)make_method(std::string(algorithm.row.name) + ":no_such=1", drawing), InputError);
  EXPECT_THROW((void)make_method("gl_chcpp:value=mine", drawing), InputError);
  EXPECT_THROW((void)make_method("gl_chcpp:threshold=0", drawing), InputError);
  EXPECT_THROW((void)make_method("gl_frustum:order=upside", drawing), InputError);
}

TEST_F(Drawing, AVersionThatNobodyHasIsUnavailableAndSaysSo) {
  try {
    const Context impossible({.major = 9, .minor = 9});
    FAIL() << "OpenGL 9.9 exists";
  } catch (const Unavailable& error) {
    const std::string line = error.what();
    EXPECT_NE(line.find("OpenGL"), std::string::npos);
    EXPECT_NE(line.find("9.9"), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos);
  }
  context()->make_current();  // the failed attempt must not take it away for good
  context()->check("after a failure");
}

TEST_F(Drawing, TooLargeAPictureIsUnavailableAndNotACrash) {
  const Scene scene = cases::gap_scene(0.1f);
  SceneDrawing drawing(*context(), scene);
  Target target;
  EXPECT_THROW(target.resize(1 << 20, 1 << 20), Unavailable);
  while (glGetError() != GL_NO_ERROR) {
  }
}

}  // namespace
}  // namespace sightline::gl
