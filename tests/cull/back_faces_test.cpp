// What back-face culling is and is not (checklist 17.02, 17.07, 17.08, 17.10): how back sides hang together, how much
// they are, and when nothing else is needed.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>

#include "sightline/geometry/face_planes.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/generate/shapes.hpp"

namespace sightline {
namespace {

Scene scene_of(const Mesh& mesh) {
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(mesh), identity_affine());
  return builder.build();
}

View view_of(const glm::dvec3& eye) {
  View view = look_along(eye, -eye);
  view.width = view.height = 96;
  view.fov_y = 0.9;
  return view;
}

std::vector<bool> kept_by(const std::string& method, const Scene& scene, const View& view) {
  const IndexedScene indexed = index_scene(scene);
  const auto culler = make_face_culler(method, indexed);
  FaceSet kept;
  Counters counters;
  culler->cull(view, VisibleSet::all(1), kept, counters);
  const FaceSet::Part& part = kept.parts()[0];
  const auto order = culler->order(0);
  std::vector<bool> result(part.triangles);
  for (std::size_t place = 0; place < part.triangles; ++place)
    result[order.empty() ? place : order[place]] = kept.contains(part, place);
  return result;
}

/// Connected parts of the back side, over edges that two culled triangles share.
int back_sides(const Mesh& mesh, const std::vector<bool>& kept) {
  std::vector<std::size_t> root(mesh.triangles.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t t) {
    while (root[t] != t) t = root[t] = root[root[t]];
    return t;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3 && !kept[t]; ++k) {
      const auto [a, b] = std::minmax({mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]});
      const auto [at, fresh] = edges.try_emplace({a, b}, t);
      if (!fresh) root[find(t)] = find(at->second);
    }
  int parts = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) parts += !kept[t] && find(t) == t ? 1 : 0;
  return parts;
}

/// Share of the kept triangles that a pixel of the image sees, and the other way round: pixels on culled triangles.
struct Seen {
  double share = 0.0;
  std::size_t wrong = 0, pixels = 0;
};
Seen seen_of(const Scene& scene, const View& view, const std::vector<bool>& kept) {
  Frame frame;
  Oracle(scene).draw(view, frame);
  std::vector<bool> hit(kept.size());
  Seen seen;
  for (std::size_t i = 0; i < frame.object.size(); ++i) {
    if (frame.object[i] == no_object) continue;
    ++seen.pixels;
    hit[frame.triangle[i]] = true;
    seen.wrong += kept[frame.triangle[i]] ? 0 : 1;
  }
  const auto count = [](const std::vector<bool>& v) {
    return static_cast<double>(std::count(v.begin(), v.end(), true));
  };
  seen.share = count(hit) / count(kept);
  return seen;
}

/// A ball with two waists: three bumps in a row along y.
Mesh three_bumps() {
  Mesh mesh = make_ball(60, 60);
  for (glm::vec3& p : mesh.positions) {
    const float waist = 0.35f + 0.65f * std::abs(std::cos(3.14159265f * 1.5f * p.y));
    p *= glm::vec3(waist, 2.0f, waist);
  }
  return mesh;
}

/// 17.02: a convex solid has exactly one connected back side; another may have several.
TEST(BackFaces, AConvexSolidHasOneBackSideOthersMayHaveSeveral) {
  Random random(3);
  const Mesh ball = make_ball(24, 16), box = make_box({-1, -2, -0.5}, {1, 2, 0.5}), bumps = three_bumps();
  const Scene balls = scene_of(ball), boxes = scene_of(box), waves = scene_of(bumps);
  ASSERT_EQ(solidity_of(waves.meshes()[0]), Solidity::solid);
  int most = 0;
  for (int i = 0; i < 40; ++i) {
    const View view = view_of(random.range(2.5, 9) * random.direction());
    EXPECT_EQ(back_sides(ball, kept_by("backface", balls, view)), 1);
    EXPECT_EQ(back_sides(box, kept_by("backface", boxes, view)), 1);
    most = std::max(most, back_sides(bumps, kept_by("backface", waves, view)));
  }
  const View along = view_of({1.2, 7, 0});
  EXPECT_GE(std::max(most, back_sides(bumps, kept_by("backface", waves, along))), 2);
}

/// 17.07: half of the triangles on average over all directions, as each is a back face from one of two opposite ones.
TEST(BackFaces, AreHalfOnAverage) {
  Random random(4);
  const Mesh bumps = three_bumps();
  const FacePlanes planes = make_face_planes(bumps.positions, bumps.triangles, {});
  std::vector<std::uint64_t> kept((bumps.triangles.size() + 63) / 64);
  double culled = 0.0;
  constexpr int directions = 200;
  for (int i = 0; i < directions; ++i)
    culled +=
        static_cast<double>(front_faces(planes, glm::vec4(glm::vec3(random.direction()), 0.0f), 1e-7f, kept.data()));
  EXPECT_NEAR(culled / directions / static_cast<double>(bumps.triangles.size()), 0.5, 0.02);
}

/// 17.08: of a single convex solid what back-face culling keeps is what is seen; of a concave one a part is hidden.
TEST(BackFaces, SolveASingleConvexSolidAndNoOther) {
  Random random(5);
  const Mesh ball = make_ball(8, 6);
  const Scene convex = scene_of(ball), concave = scene_of(three_bumps());
  for (int i = 0; i < 10; ++i) {
    const View view = view_of(random.range(2.2, 3) * random.direction());
    const Seen seen = seen_of(convex, view, kept_by("backface", convex, view));
    EXPECT_GT(seen.pixels, 500u);
    EXPECT_EQ(seen.wrong, 0u);
    EXPECT_GT(seen.share, 0.85) << "all but what is edge-on or falls between pixels";
  }
  View view = view_of({0.2, 6, 0.1});  // along the row: the first bump hides the others
  view.fov_y = 0.4;
  view.width = view.height = 400;
  const Seen seen = seen_of(concave, view, kept_by("backface", concave, view));
  EXPECT_EQ(seen.wrong, 0u);
  EXPECT_LT(seen.share, 0.8);
}

/// 17.10: six faces N1 .. N6 around a prism, seen in one direction p; p . N_i > 0 are the back faces.
TEST(BackFaces, OfSixFacesThreeTurnTheirBacks) {
  constexpr double sixth = 3.14159265358979 / 3.0;
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  std::vector<glm::dvec3> normals;
  for (int i = 0; i < 6; ++i) {
    const glm::dvec3 a(std::cos(sixth * i), 0, std::sin(sixth * i)),
        b(std::cos(sixth * (i + 1)), 0, std::sin(sixth * (i + 1)));
    const auto first = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {glm::vec3(a), glm::vec3(a) + glm::vec3(0, 1, 0), glm::vec3(b)});
    triangles.push_back({first, first + 1, first + 2});
    normals.push_back(glm::normalize(a + b));
  }
  const FacePlanes planes = make_face_planes(positions, triangles, {});
  for (const double turn : {0.1, 1.3, 2.9, 4.4}) {
    const glm::dvec3 p(std::cos(turn), 0, std::sin(turn));
    std::uint64_t kept = 0;
    EXPECT_EQ(front_faces(planes, glm::vec4(glm::vec3(-p), 0.0f), 1e-6f, &kept), 3u);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ((kept >> i) & 1, glm::dot(p, normals[i]) > 0.0 ? 0u : 1u) << i;
  }
}

}  // namespace
}  // namespace sightline
