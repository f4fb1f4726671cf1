// Which faces cameras see: counts against the oracle, completeness against a finer oracle, witnesses by rays.
#include "sightline/surface/visible_faces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "agreement/cases.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/polygon_fill.hpp"
#include "sightline/raster/scene_polygons.hpp"
#include "sightline/raster/scene_rays.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/generate/shapes.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

struct Seen {
  std::vector<std::uint32_t> samples;
  std::vector<std::uint8_t> seen;
};

std::vector<Seen> look(const Scene& scene, const std::vector<CalibratedCamera>& cameras, int extra = 4) {
  std::vector<Seen> result(cameras.size());
  visible_faces(scene, cameras, {extra}, [&](std::size_t i, const CameraFaces& faces) {
    result[i].samples.assign(faces.samples.begin(), faces.samples.end());
    result[i].seen.assign(faces.seen.begin(), faces.seen.end());
  });
  return result;
}

std::vector<std::uint32_t> faces_of(const Scene& scene, const Frame& frame) {
  const std::vector<std::uint64_t> first = first_faces(scene);
  std::vector<std::uint32_t> samples(first.back(), 0);
  for (std::size_t i = 0; i < frame.object.size(); ++i)
    if (frame.object[i] != no_object) ++samples[first[frame.object[i]] + frame.triangle[i]];
  return samples;
}

std::vector<View> views_of(const Scene& scene) {
  std::vector<View> views;
  for (View view : cases::hard_views(scene, 10, 6)) {
    view.far = std::min(view.far, 1e6);
    views.push_back(view);
  }
  return views;
}

/// How many pixel centres may show a face: all where none lies nearer by more than `tie` (relative), and not fewer than
/// those where no other face lies so near. `frame` says how near the nearest is.
struct Share {
  std::vector<std::uint32_t> fewest, most;
};

Share shares(const Scene& scene, const View& view, const Frame& frame, float tie) {
  const PolygonSet faces = scene_polygons(scene, 1'000'000, "test").polygons;
  const ImageMap map(view);
  PolygonFill fill;
  Share result;
  result.fewest.assign(faces.corners.size() / 3, 0);
  result.most = result.fewest;
  std::vector<std::uint32_t> near(frame.depth.size(), 0), last(frame.depth.size(), 0);
  for (std::uint32_t f = 0; f < result.most.size(); ++f) {
    glm::dvec3 corners[3];
    for (std::size_t i = 0; i < 3; ++i) corners[i] = map.view_point(faces.corners[3 * f + i]);
    if (!fill.set(map, corners)) continue;
    fill.fill([&](int x, int y, float depth) {
      const std::size_t at = frame.index(x, y);
      if (depth > frame.depth[at] * (1.0f + tie)) return;
      ++result.most[f];
      ++near[at];
      last[at] = f;
    });
  }
  for (std::size_t at = 0; at < near.size(); ++at)
    if (near[at] == 1) ++result.fewest[last[at]];
  return result;
}

/// Pixels that faces have above or below their share.
std::size_t outside(const Share& share, const std::vector<std::uint32_t>& samples) {
  std::size_t pixels = 0;
  for (std::size_t f = 0; f < samples.size(); ++f) {
    if (samples[f] < share.fewest[f]) pixels += share.fewest[f] - samples[f];
    if (samples[f] > share.most[f]) pixels += samples[f] - share.most[f];
  }
  return pixels;
}

/// The same with glass made opaque: a frame has one face a pixel, while all faces of glass before it are seen, too.
Scene without_glass(const Scene& scene) {
  SceneBuilder builder;
  for (const Mesh& mesh : scene.meshes()) builder.add_mesh(mesh);
  for (const Object& object : scene.objects()) builder.add_object(object.mesh, object.transform);
  return builder.build();
}

TEST(VisibleFaces, SampleCountsAreThoseOfTheOracleAndTheZBuffer) {
  for (const char* kind : {"city", "building", "soup"}) {
    const Scene scene = without_glass(generate_scene(kind, {.objects = 150, .seed = 3}));
    const Oracle oracle(scene);
    const IndexedScene indexed = index_scene(scene);
    const auto zbuffer = make_renderer("zbuffer", indexed);
    std::vector<CalibratedCamera> cameras;
    std::vector<View> views = views_of(scene);
    for (const View& view : views) cameras.push_back(calibrated(view));
    const std::vector<Seen> ours = look(scene, cameras);
    for (std::size_t i = 0; i < views.size(); ++i) {
      Frame truth, drawn;
      oracle.draw(views[i], truth);
      Counters counters;
      zbuffer->draw(views[i], VisibleSet::all(scene.objects().size()), drawn, counters);
      for (std::size_t f = 0; f < ours[i].seen.size(); ++f)
        ASSERT_TRUE(ours[i].samples[f] == 0 || ours[i].seen[f] == 1);
      std::size_t of_zbuffer = 0, edges = 0;
      for (std::size_t p = 0; p < truth.object.size(); ++p) {
        of_zbuffer += drawn.object[p] != no_object ? 1 : 0;
        if (truth.object[p] == no_object && drawn.object[p] == no_object) continue;
        edges += std::abs(truth.depth[p] - drawn.depth[p]) <= 1e-5f * truth.depth[p] ? 0 : 1;
      }
      const std::string where = kind + (" " + describe(views[i]));
      EXPECT_LE(edges, 2u) << where;
      // Of faces at equal depth, as far as floats and rays can tell, any may be shown.
      const Share as_drawn = shares(scene, views[i], drawn, 1.2e-6f), as_traced = shares(scene, views[i], truth, 1e-5f);
      EXPECT_EQ(outside(as_drawn, ours[i].samples), 0u) << where;
      EXPECT_LE(outside(as_traced, ours[i].samples), 2 * edges) << where;
      EXPECT_EQ(std::accumulate(ours[i].samples.begin(), ours[i].samples.end(), std::size_t{0}), of_zbuffer) << where;
    }
  }
}

/// A bumpy ball of faces much smaller than a pixel, before a wall.
Scene fine_ball() {
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(make_ball(120, 60)), identity_affine());
  builder.add_object(builder.add_mesh(cases::quad({-4, -4, -2}, {8, 0, 0}, {0, 8, 0})), identity_affine());
  return builder.build();
}

/// Independent of the raster: does a ray through one of the four points of the face's projection meet it first?
bool has_witness(const SceneRays& rays, const Scene& scene, const CalibratedCamera& camera, std::size_t face) {
  const std::vector<std::uint64_t> first = first_faces(scene);
  ObjectId object = 0;
  while (first[object + 1] <= face) ++object;
  glm::dvec3 c[3];
  rays.corners(object, static_cast<std::uint32_t>(face - first[object]), c);
  glm::dvec2 image[3], middle(0.0);
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 p = camera.to_camera(c[i]);
    image[i] = {p.x / p.z, p.y / p.z};
    middle += image[i] / 3.0;
  }
  for (int i = -1; i < 3; ++i) {
    const glm::dvec2 at = i < 0 ? middle : middle + 0.85 * (image[i] - middle);
    SceneRayHit hit;
    const glm::dvec3 direction = glm::transpose(camera.rotation) * glm::dvec3(at, 1.0);
    if (rays.nearest({camera.centre, direction, camera.near, camera.far}, hit) && hit.object == object &&
        hit.triangle == face - first[object])
      return true;
  }
  return false;
}

TEST(VisibleFaces, FacesSmallerThanAPixelAreFound) {
  const Scene scene = fine_ball();
  View view = look_along({0.3, 0.4, 6}, {0, 0, -1});
  view.width = view.height = 48;
  view.near = 0.1;
  view.far = 100;
  View fine = view;
  fine.width = fine.height = 48 * 40;
  Frame frame;
  Oracle(scene).draw(fine, frame);
  const std::vector<std::uint32_t> truth = faces_of(scene, frame);
  const SceneRays rays(scene);
  std::size_t seen[3] = {}, missed[3] = {}, extra[3] = {}, unproven[3] = {}, all = 0;
  for (const int points : {0, 1, 4}) {
    const std::vector<Seen> ours = look(scene, {calibrated(view)}, points);
    const int k = points == 4 ? 2 : points;
    all = 0;
    for (std::size_t f = 0; f < truth.size(); ++f) {
      all += truth[f] > 0;
      seen[k] += ours[0].seen[f];
      missed[k] += truth[f] > 2 && ours[0].seen[f] == 0 ? 1 : 0;
      if (truth[f] > 0 || ours[0].seen[f] == 0) continue;
      ++extra[k];
      unproven[k] += has_witness(rays, scene, calibrated(view), f) ? 0 : 1;
    }
  }
  EXPECT_GT(all, 2500u);
  EXPECT_LT(seen[0], all / 2) << "most faces have no pixel centre";
  EXPECT_LE(missed[1] * 100, all) << "one point for each finds nearly all";
  EXPECT_LE(missed[2] * 200, all);
  EXPECT_LE(missed[2], missed[1]);
  EXPECT_LE(extra[2] * 20, all) << "faces at the rim that even the fine picture lacks";
  EXPECT_LE(unproven[2] * 1000, all) << "rays confirm those";
}

TEST(VisibleFaces, HiddenFacesAreNotReported) {
  SceneBuilder builder;  // a fine ball behind a wall, seen from before it
  builder.add_object(builder.add_mesh(make_ball(60, 30)), cases::at({0, 0, -3}));
  builder.add_object(builder.add_mesh(cases::quad({-40, -40, 0}, {80, 0, 0}, {0, 80, 0})), identity_affine());
  const Scene scene = builder.build();
  View view = look_along({0, 0, 5}, {0, 0, -1});
  view.width = 64;
  view.height = 48;
  const std::vector<Seen> ours = look(scene, {calibrated(view)});
  for (std::size_t f = 0; f + 2 < ours[0].seen.size(); ++f) ASSERT_EQ(ours[0].seen[f], 0) << f;
  EXPECT_EQ(ours[0].samples[ours[0].samples.size() - 2] + ours[0].samples.back(), 64u * 48u);
}

TEST(VisibleFaces, GlassHidesNothing) {
  SceneBuilder builder;
  const MeshId wall = builder.add_mesh(cases::quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}));
  builder.add_object(wall, cases::at({0, 0, 0}), "wall");
  builder.add_object(wall, cases::at({0, 0, 1}), "glass", {}, false);
  builder.add_object(wall, cases::at({0, 0, -1}), "glass behind", {}, false);
  const Scene scene = builder.build();
  View view = look_along({0.1, 0.2, 5}, {0, 0, -1});
  view.width = view.height = 20;
  const Seen seen = look(scene, {calibrated(view)})[0];
  EXPECT_EQ(seen.samples[0] + seen.samples[1], 400u);
  EXPECT_EQ(seen.samples[2] + seen.samples[3], 400u);
  EXPECT_EQ(seen.seen[4] + seen.seen[5], 0);
}

TEST(VisibleFaces, IntrinsicsMoveThePicture) {
  SceneBuilder builder;  // a small square that projects to known pixels
  builder.add_object(builder.add_mesh(cases::quad({-0.5f, -0.5f, -10}, {1, 0, 0}, {0, 1, 0})), identity_affine());
  const Scene scene = builder.build();
  CalibratedCamera camera;
  camera.width = 100;
  camera.height = 80;
  camera.fx = 200;  // 20 pixels wide, 10 high
  camera.fy = 100;
  camera.cx = 50;
  camera.cy = 40;
  camera.rotation = glm::dmat3(1, 0, 0, 0, -1, 0, 0, 0, -1);
  const auto pixels = [&](const CalibratedCamera& c) {
    const Seen seen = look(scene, {c})[0];
    return seen.samples[0] + seen.samples[1];
  };
  EXPECT_EQ(pixels(camera), 200u);
  camera.cx = 0;  // half of it is left of the image
  EXPECT_EQ(pixels(camera), 100u);
  camera.cy = 80;
  EXPECT_EQ(pixels(camera), 50u);
  camera.cx = -11;
  EXPECT_EQ(pixels(camera), 0u);
  camera.cx = 50;
  camera.cy = 40;
  camera.near = 11;
  EXPECT_EQ(pixels(camera), 0u);
  camera.near = 1;
  camera.far = 9;
  EXPECT_EQ(pixels(camera), 0u);
  camera.far = 20;
  camera.projection = Projection::orthographic;
  camera.fx = 30;
  camera.fy = 20;
  EXPECT_EQ(pixels(camera), 600u);
}

TEST(VisibleFaces, SameForAnyNumberOfThreads) {
  const Scene scene = generate_scene("city", {.objects = 100});
  std::vector<CalibratedCamera> cameras;
  for (const View& view : views_of(scene)) cameras.push_back(calibrated(view));
  std::vector<Seen> results[2];
  for (int i = 0; i < 2; ++i) {
    const ThreadLimit limit(i == 0 ? 1 : 4);
    results[i] = look(scene, cameras);
  }
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    EXPECT_EQ(results[0][i].samples, results[1][i].samples);
    EXPECT_EQ(results[0][i].seen, results[1][i].seen);
  }
}

TEST(VisibleFaces, DegenerateScenesAndCameras) {
  const Scene scenes[] = {SceneBuilder().build(), cases::degenerate_scene(), cases::awkward_scene(2, 0)};
  for (const Scene& scene : scenes) {
    std::vector<CalibratedCamera> cameras;
    if (!scene.objects().empty())
      for (const View& view : views_of(scene)) cameras.push_back(calibrated(view));
    CalibratedCamera one;
    one.width = one.height = 1;
    cameras.push_back(one);
    EXPECT_NO_THROW(look(scene, cameras));
  }
  CalibratedCamera bad;
  EXPECT_THROW(look(scenes[0], {bad}), InputError) << "no pixels";
  bad.width = bad.height = 10;
  bad.fx = 0;
  EXPECT_THROW(look(scenes[0], {bad}), InputError);
  bad.fx = 10;
  bad.rotation = glm::dmat3(2.0);
  EXPECT_THROW(look(scenes[0], {bad}), InputError);
  bad.rotation = glm::dmat3(1, 0, 0, 0, 1, 0, 0, 0, -1);
  EXPECT_THROW(look(scenes[0], {bad}), InputError) << "mirrors";
}

}  // namespace
}  // namespace sightline
