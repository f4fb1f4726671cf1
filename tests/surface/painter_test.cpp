// The painters: cyclic overlap and penetration, the orders of sorting, fragments, limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "agreement/cases.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

View view_from(const glm::dvec3& eye, const glm::dvec3& look, int width = 200, int height = 150) {
  View view = look_along(eye, look);
  view.width = width;
  view.height = height;
  view.near = 0.01;
  view.far = 100;
  return view;
}

Frame draw(const std::string& method, const Scene& scene, const View& view, Counters* counters = nullptr) {
  const IndexedScene indexed = index_scene(scene);
  Frame frame;
  Counters own;
  make_renderer(method, indexed)
      ->draw(view, VisibleSet::all(scene.objects().size()), frame, counters != nullptr ? *counters : own);
  return frame;
}

/// Pixels whose object is not the oracle's; pixels next to a change of the truth are edges and left out.
std::size_t wrong_pixels(const Frame& frame, const Frame& truth) {
  std::size_t wrong = 0;
  for (int y = 1; y + 1 < truth.height; ++y)
    for (int x = 1; x + 1 < truth.width; ++x) {
      const ObjectId id = truth.object[truth.index(x, y)];
      bool edge = false;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) edge |= truth.object[truth.index(x + dx, y + dy)] != id;
      if (!edge && frame.object[frame.index(x, y)] != id) ++wrong;
    }
  return wrong;
}

std::size_t error_of(const std::string& method, const Scene& scene, const View& view) {
  Frame truth;
  Oracle(scene).draw(view, truth);
  return wrong_pixels(draw(method, scene, view), truth);
}

Scene triangles(const std::vector<std::array<glm::vec3, 3>>& all) {
  SceneBuilder builder;
  for (const auto& t : all)
    builder.add_object(builder.add_mesh({"t", {t[0], t[1], t[2]}, {{0, 1, 2}}, false, {}}), identity_affine());
  return builder.build();
}

/// Three long triangles, each over the next one (2.04).
Scene cyclic() {
  std::vector<std::array<glm::vec3, 3>> all;
  for (int i = 0; i < 3; ++i) {
    const double a = 2.0943951023931953 * i;
    const auto at = [&](double along, double across, double z) {
      return glm::vec3(along * std::cos(a) - across * std::sin(a), along * std::sin(a) + across * std::cos(a), z);
    };
    all.push_back({at(-3, -1.2, 0.5), at(3, -1.4, -0.5), at(3, -0.5, -0.5)});
  }
  return triangles(all);
}

Scene crossing() {
  return triangles({{glm::vec3(-2, -1, -1), {2, -1, 1}, {0, 2, 0}}, {glm::vec3(-2, -1, 1), {2, -1, -1}, {0, 2, 0.2f}}});
}

TEST(Painter, SortableSceneIsRight) {
  std::vector<std::array<glm::vec3, 3>> all;
  for (int i = 0; i < 12; ++i) {
    const auto z = static_cast<float>((i * 5) % 12), x = 0.1f * static_cast<float>(i);
    all.push_back({glm::vec3(x - 1, -1, z), {x + 1, -1, z}, {x, 1, z}});
  }
  const Scene scene = triangles(all);
  const View view = view_from({0, 0, 16}, {0, 0, -1});
  for (const char* method :
       {"painter", "painter:key=centroid", "painter:key=nearest", "painter:split=on", "painter_bsp"})
    EXPECT_EQ(error_of(method, scene, view), 0u) << method;
}

TEST(Painter, CyclicOverlapAndPenetrationNeedCuts) {
  const View view = view_from({0, 0, 6}, {0, 0, -1}, 600, 450);
  const Scene scenes[] = {cyclic(), crossing()};
  for (const Scene& scene : scenes) {
    for (const char* key : {"farthest", "centroid", "nearest"})
      EXPECT_GT(error_of(std::string("painter:key=") + key, scene, view), 50u) << key;
    for (const char* method : {"painter:split=on", "painter_bsp", "painter_bsp:near_to_far=on",
                               "painter_bsp:splitter=random", "painter_bsp:splitter=pca", "painter_bsp:splitter=first"})
      EXPECT_EQ(error_of(method, scene, view), 0u) << method;
    View flat = view;
    flat.projection = Projection::orthographic;
    flat.span_y = 5;
    for (const char* method : {"painter:split=on", "painter_bsp"}) EXPECT_EQ(error_of(method, scene, flat), 0u);
  }
}

TEST(Painter, ErrorIsThatOfTheKeyAndCutsEndIt) {
  GenerateConfig config;
  config.objects = 60;
  const Scene scene = generate_scene("soup", config);
  const glm::dvec3 centre(scene.bounds().centre());
  const double size = glm::length(glm::dvec3(scene.bounds().extent()));
  View view = view_from(centre + glm::dvec3(0.2, 0.3, 0.9) * size, {-0.2, -0.3, -0.9});
  view.far = 3 * size;
  EXPECT_GT(error_of("painter", scene, view), 0u);
  EXPECT_EQ(error_of("painter:split=on", scene, view), 0u);
  EXPECT_EQ(error_of("painter_bsp", scene, view), 0u);
}

TEST(Painter, EverySplitterAndBothOrdersDrawTheSame) {
  const Scene scene = cases::awkward_scene(4, 0);
  for (const View& view : cases::hard_views(scene, 12, 9)) {
    const Frame one = draw("painter_bsp", scene, view);
    Frame truth;
    Oracle(scene).draw(view, truth);
    for (const char* method :
         {"painter_bsp:near_to_far=on", "painter_bsp:splitter=random", "painter_bsp:splitter=fewest_splits",
          "painter_bsp:splitter=balance", "painter_bsp:splitter=pca"}) {
      const Frame other = draw(method, scene, view);
      std::size_t differ = 0;
      for (std::size_t i = 0; i < one.object.size(); ++i)
        differ += one.object[i] != other.object[i] && std::abs(one.depth[i] - other.depth[i]) > 1e-6f * one.depth[i];
      EXPECT_LE(differ * 5000, one.object.size() + 4999) << method << " " << describe(view);
    }
  }
}

TEST(Painter, CoplanarFacesGoToTheLowerId) {
  SceneBuilder builder;
  const MeshId wall = builder.add_mesh(cases::quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}));
  builder.add_object(wall, identity_affine());
  builder.add_object(wall, identity_affine());
  const Scene scene = builder.build();
  for (const char* method : {"painter", "painter:split=on", "painter_bsp", "painter_bsp:near_to_far=on"})
    for (const double side : {3.0, -3.0}) {
      const Frame frame = draw(method, scene, view_from({0.1, 0.2, side}, {0, 0, -side}));
      EXPECT_EQ(std::count(frame.object.begin(), frame.object.end(), 1u), 0) << method;
      EXPECT_GT(std::count(frame.object.begin(), frame.object.end(), 0u), 5000) << method;
    }
}

TEST(Painter, OnlyVisibleObjectsArePainted) {
  const Scene scene = cyclic();
  const IndexedScene indexed = index_scene(scene);
  VisibleSet some(3);
  some.insert(1);
  for (const char* method : {"painter", "painter:split=on", "painter_bsp", "whitted", "zbuffer"}) {
    Frame frame;
    Counters counters;
    make_renderer(method, indexed)->draw(view_from({0, 0, 6}, {0, 0, -1}), some, frame, counters);
    for (const ObjectId id : frame.object) ASSERT_TRUE(id == no_object || id == 1) << method;
    EXPECT_GT(std::count(frame.object.begin(), frame.object.end(), 1u), 500) << method;
  }
}

TEST(Painter, OverdrawIsCounted) {  // far to near paints pixels again and again (15.12), near to far once
  const Scene scene = cases::gap_scene(0.02f);
  const View view = view_from({0.3, 0.2, 4}, {0, 0, -1});
  Counters far_to_near, near_to_far;
  const Frame a = draw("painter_bsp", scene, view, &far_to_near);
  const Frame b = draw("painter_bsp:near_to_far=on", scene, view, &near_to_far);
  const auto covered = static_cast<std::uint64_t>(
      a.object.size() - static_cast<std::size_t>(std::count(a.object.begin(), a.object.end(), no_object)));
  EXPECT_EQ(near_to_far.pixels_written, covered);
  EXPECT_GT(far_to_near.pixels_written, covered);
  EXPECT_EQ(a.object, b.object);
}

TEST(Painter, LimitsAndNamesAreClear) {
  const Scene scene = generate_scene("city", {.objects = 40});
  const View view = view_from({0, 2, 0}, {1, 0, 0});
  EXPECT_THROW(draw("painter_bsp:most_triangles=100", scene, view), InputError);
  EXPECT_THROW(draw("painter_bsp:most_fragments=100", scene, view), InputError);
  EXPECT_THROW(draw("painter:split=on:most_fragments=10", scene, view), InputError);
  EXPECT_THROW(draw("painter:key=colour", scene, view), InputError);
  EXPECT_THROW(draw("painter_bsp:splitter=luck", scene, view), InputError);
  EXPECT_NO_THROW(draw("painter_bsp", SceneBuilder().build(), view));
  EXPECT_NO_THROW(draw("painter:split=on", SceneBuilder().build(), view));
}

}  // namespace
}  // namespace sightline
