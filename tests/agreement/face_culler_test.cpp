// Every face culler of the registry: never culls a triangle that faces the eye (orientation in quadruple precision),
// never changes the image of closed solids seen from outside, leaves alone what is no solid, and finds a fair share.
#include <gtest/gtest.h>

#include <map>

#include "agreement/cases.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/generate/shapes.hpp"

namespace sightline {
namespace {

__extension__ typedef __float128 Quad;

std::vector<std::string> contenders() {
  std::vector<std::string> all;
  for (const Algorithm& row : algorithms())
    if (row.family == Family::face_culler) all.emplace_back(row.name);
  for (const char* text : {"backface:scalar=on", "normal_mask:n=6", "normal_mask:n=1", "normal_mask:sectors=4:chunk=64",
                           "normal_mask:n=18:sectors=3:scalar=on", "cluster_backface:leaf=1:cost=0.001",
                           "cluster_backface:leaf=16:origins=off:scalar=on", "cluster_backface:position=0:cost=100",
                           "cluster_backface:leaf=64"})
    all.emplace_back(text);
  return all;
}

struct Vec {
  Quad x, y, z;
};
Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec quad(const glm::dvec3& p) { return {p.x, p.y, p.z}; }
Quad absolute(Quad q) { return q < 0 ? -q : q; }

/// Sign of det(a, b, c) where quadruple precision tells for sure, else 0.
int sign_of(const Vec& a, const Vec& b, const Vec& c) {
  const Quad terms[6] = {a.x * b.y * c.z,  a.y * b.z * c.x,  a.z * b.x * c.y,
                         -a.z * b.y * c.x, -a.y * b.x * c.z, -a.x * b.z * c.y};
  Quad sum = 0, size = 0;
  for (const Quad term : terms) {
    sum += term;
    size += absolute(term);
  }
  const Quad certain = size * static_cast<Quad>(1e-30);
  return sum > certain ? 1 : sum < -certain ? -1 : 0;
}

glm::dvec3 rough(const Vec& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

/// +1 if the triangle faces the eye, -1 if it turns its back, 0 if it is edge-on or too close to tell. `unsure`: how
/// far each corner may lie elsewhere; then 0 as well if that could change the sign.
int facing(const View& view, const std::array<Vec, 3>& p, double unsure = 0.0) {
  const Vec to = view.projection == Projection::perspective ? quad(view.eye) - p[0] : quad(-view_direction(view));
  const Vec a = p[1] - p[0], b = p[2] - p[0];
  const glm::dvec3 u = rough(a), v = rough(b), w = rough(to);
  const double det = glm::dot(glm::cross(u, v), w), lu = glm::length(u), lv = glm::length(v), lw = glm::length(w);
  if (std::abs(det) > 1e-13 * lu * lv * lw + 8.0 * unsure * (lu * lv + lv * lw + lw * lu)) return det > 0 ? 1 : -1;
  return unsure > 0.0 ? 0 : sign_of(a, b, to);
}

/// Corners in the world: as floats that renderers share, or exactly where the transform puts them.
std::array<Vec, 3> corners_of(const Object& object, const Mesh& mesh, std::size_t triangle, bool exact) {
  std::array<Vec, 3> corners;
  for (int k = 0; k < 3; ++k) {
    const glm::vec3& p = mesh.positions[mesh.triangles[triangle][k]];
    const Affine& m = object.transform;
    if (!exact) {
      corners[static_cast<std::size_t>(k)] = quad(glm::dvec3(transform_point(m, p)));
      continue;
    }
    const auto row = [&](int r) {
      return static_cast<Quad>(m[0][r]) * p.x + static_cast<Quad>(m[1][r]) * p.y + static_cast<Quad>(m[2][r]) * p.z +
             m[3][r];
    };
    corners[static_cast<std::size_t>(k)] = {row(0), row(1), row(2)};
  }
  return corners;
}

/// True if a part of the triangle lies well within the four side planes of the image.
bool in_image(const View& view, const std::array<Vec, 3>& p) {
  std::vector<glm::dvec3> polygon;
  for (const Vec& v : p)
    polygon.emplace_back(static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z));
  const glm::dmat4 rows = glm::transpose(view_projection(view));
  for (int axis = 0; axis < 2; ++axis)
    for (const double sign : {1.0, -1.0}) {
      const glm::dvec4 plane = (rows[3] + sign * rows[axis]) / glm::length(glm::dvec3(rows[3] + sign * rows[axis]));
      const auto side = [&](const glm::dvec3& q) {
        return glm::dot(plane, glm::dvec4(q, 1.0)) - 1e-9 * glm::length(view.eye - q);
      };
      std::vector<glm::dvec3> cut;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double da = side(a), db = side(b);
        if (da > 0) cut.push_back(a);
        if ((da > 0) != (db > 0)) cut.push_back(a + (b - a) * (da / (da - db)));
      }
      polygon = cut;
    }
  return polygon.size() >= 3;
}

struct Shares {
  std::size_t back = 0, culled = 0;
};

/// How far rounding to float moves a corner at most.
double rounding_of(const Object& object, const Mesh& mesh) {
  const glm::dvec3 size(glm::max(glm::abs(mesh.bounds.lo), glm::abs(mesh.bounds.hi)));
  double terms = glm::length(glm::dvec3(object.transform[3]));
  for (int k = 0; k < 3; ++k) terms += glm::length(glm::dvec3(object.transform[k])) * size[k];
  return 1e-6 * terms;
}

/// Which way every triangle of a scene faces, of the corners that renderers share; mirrored objects by their outside.
std::vector<std::vector<signed char>> sides_of(const Scene& scene, const View& view) {
  std::vector<std::vector<signed char>> sides(scene.objects().size());
  for (ObjectId id = 0; id < scene.objects().size(); ++id) {
    const Object& object = scene.objects()[id];
    const Mesh& mesh = scene.mesh_of(id);
    const int mirror = determinant(object.transform) < 0.0f ? -1 : 1;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      sides[id].push_back(static_cast<signed char>(mirror * facing(view, corners_of(object, mesh, t, false))));
  }
  return sides;
}

/// True if a culled triangle faces the eye, rounded or exact, within the image.
bool wrongly_culled(const Scene& scene, const View& view, ObjectId id, std::size_t t, int side) {
  const Object& object = scene.objects()[id];
  const Mesh& mesh = scene.mesh_of(id);
  const auto rounded = corners_of(object, mesh, t, false);
  if (side < 0 && facing(view, rounded, rounding_of(object, mesh)) != 0) return false;
  const int exact = (determinant(object.transform) < 0.0f ? -1 : 1) * facing(view, corners_of(object, mesh, t, true));
  return (side > 0 || exact > 0) && in_image(view, rounded);
}

/// Checks one view; adds to the shares, by contender.
void check_view_of(const std::string& name, const Scene& scene, const View& view, const std::vector<std::string>& names,
                   std::vector<std::unique_ptr<FaceCuller>>& cullers, std::map<std::string, Shares>& shares) {
  const VisibleSet all = VisibleSet::all(scene.objects().size());
  const auto sides = sides_of(scene, view);
  for (std::size_t c = 0; c < cullers.size(); ++c) {
    FaceSet kept;
    Counters counters;
    cullers[c]->cull(view, all, kept, counters);
    ASSERT_EQ(kept.parts().size(), scene.objects().size());
    std::size_t total = 0;
    for (const FaceSet::Part& part : kept.parts()) {
      const Object& object = scene.objects()[part.object];
      total += part.triangles;
      ASSERT_EQ(part.triangles, scene.mesh_of(part.object).triangles.size());
      if (!object.opaque || cullers[c]->solidity(object.mesh) != Solidity::solid) {
        EXPECT_EQ(kept.count(part), part.triangles) << names[c] << " culls object " << part.object << " of " << name;
        continue;
      }
      const auto order = cullers[c]->order(object.mesh);
      for (std::size_t place = 0; place < part.triangles; ++place) {
        const std::size_t t = order.empty() ? place : order[place];
        const int side = sides[part.object][t];
        if (side < 0) ++shares[names[c]].back;
        if (kept.contains(part, place)) continue;
        if (side < 0) ++shares[names[c]].culled;
        ASSERT_FALSE(wrongly_culled(scene, view, part.object, t, side))
            << names[c] << " culls triangle " << t << " of object " << part.object << " of " << name
            << ", which faces the eye (" << describe(view) << ")";
      }
    }
    EXPECT_EQ(counters.faces_culled, total - kept.count());
  }
}

void expect_no_front_face_culled(const std::string& name, const Scene& scene, const std::vector<View>& views,
                                 std::map<std::string, Shares>& shares,
                                 const std::vector<std::string>& names = contenders()) {
  const IndexedScene indexed = index_scene(scene);
  std::vector<std::unique_ptr<FaceCuller>> cullers;
  for (const std::string& text : names) cullers.push_back(make_face_culler(text, indexed));
  for (const View& view : views) check_view_of(name, scene, view, names, cullers, shares);
}

void print(const std::map<std::string, Shares>& shares) {
  for (const auto& [name, share] : shares)
    std::printf("%-48s %9zu of %9zu back faces culled, %5.1f %%\n", name.c_str(), share.culled, share.back,
                100.0 * static_cast<double>(share.culled) / static_cast<double>(std::max<std::size_t>(share.back, 1)));
}

/// Curved and bumpy solids under rotation, mirroring, squashing and far from the origin.
Scene solids_scene(std::uint64_t seed, double far) {
  Random random(seed);
  SceneBuilder builder;
  Mesh bumpy = make_ball(40, 24);
  for (glm::vec3& p : bumpy.positions)
    p *= 1.0f + 0.2f * static_cast<float>(circle_point(p.x + 0.3 * p.y).x * circle_point(0.7 * p.z + 0.2 * p.y).y);
  Mesh needle = make_ball(60, 40);  // triangles of all widths down to slivers
  for (glm::vec3& p : needle.positions) p *= glm::vec3(1.0f, 1e-3f, 0.1f);
  Mesh odd = make_box({-1, -1, -1}, {1, 1, 1});
  odd.triangles.push_back({0, 0, 1});
  const MeshId meshes[] = {builder.add_mesh(bumpy), builder.add_mesh(needle), builder.add_mesh(odd),
                           builder.add_mesh(make_cylinder(24))};
  for (int i = 0; i < 12; ++i) {
    glm::dmat3 linear = glm::mat3_cast(glm::angleAxis(random.range(0, 6), random.direction())) * random.range(0.3, 3);
    if (i % 3 == 0) linear = linear * glm::dmat3(-1, 0, 0, 0.2, 1, 0, 0, 0, random.range(0.01, 1));
    const glm::dvec3 place = far * glm::dvec3(0.6, 0.1, -0.7) + 6.0 * random.direction();
    builder.add_object(meshes[i % 4], {linear[0], linear[1], linear[2], place});
  }
  return builder.build();
}

TEST(FaceCullerAgreement, NeverCullsAFrontFaceOfSolids) {
  std::map<std::string, Shares> shares, far_away;  // at 5 km slivers of millimetres cannot be told
  for (const std::uint64_t seed : {1, 2})
    for (const double far : {0.0, 100.0, 5000.0}) {
      const Scene scene = solids_scene(seed, far);
      expect_no_front_face_culled("solids " + std::to_string(seed) + " " + std::to_string(far), scene,
                                  cases::hard_views(scene, 24, seed), far == 0.0 ? shares : far_away);
    }
  print(shares);
  EXPECT_GT(shares["backface"].culled, shares["backface"].back * 85 / 100);
  EXPECT_GT(shares["cluster_backface"].culled, shares["cluster_backface"].back / 5);
  EXPECT_GT(shares["normal_mask"].culled, shares["normal_mask"].back / 10);
}

TEST(FaceCullerAgreement, NeverCullsAFrontFaceOfGeneratedScenes) {
  std::map<std::string, Shares> shares;
  for (const cases::Case& c : cases::generated())
    expect_no_front_face_culled(c.name, c.scene, cases::hard_views(c.scene, 3, 3), shares);
  print(shares);
  EXPECT_GT(shares["backface"].culled, shares["backface"].back / 2);
}

TEST(FaceCullerAgreement, NeverCullsAFrontFaceOfRealScenes) {
  const auto files = cases::real_scenes();
  if (files.empty()) GTEST_SKIP() << "NO REAL SCENES: the folder shared/scenes beside the checkout is missing";
  for (const auto& file : files) {
    const LoadedScene loaded = load_scene(file);
    if (loaded.scene.triangle_count() > 2'000'000)
      continue;  // a bit for each instance's triangle, in quadruple precision
    std::map<std::string, Shares> shares;
    expect_no_front_face_culled(file.filename().string(), loaded.scene, cases::hard_views(loaded.scene, 2, 5), shares,
                                {"backface", "normal_mask", "normal_mask:sectors=4", "cluster_backface"});
    std::printf("%s\n", file.filename().string().c_str());
    print(shares);
  }
}

/// Whether some kept triangle of the object is hit by the ray at about this depth: the pixel lies on an edge.
bool kept_at_depth(const Scene& scene, const FaceCuller& culler, const FaceSet& kept, const FaceSet::Part& part,
                   const PixelRay& ray, double depth) {
  const Object& object = scene.objects()[part.object];
  const Mesh& mesh = scene.mesh_of(part.object);
  const auto order = culler.order(object.mesh);
  for (std::size_t place = 0; place < part.triangles; ++place) {
    if (!kept.contains(part, place)) continue;
    const glm::uvec3& t = mesh.triangles[order.empty() ? place : order[place]];
    const glm::dvec3 a(transform_point(object.transform, mesh.positions[t.x])),
        u = glm::dvec3(transform_point(object.transform, mesh.positions[t.y])) - a,
        v = glm::dvec3(transform_point(object.transform, mesh.positions[t.z])) - a, h = glm::cross(ray.direction, v);
    const double det = glm::dot(u, h);
    if (det == 0.0) continue;
    const glm::dvec3 s = ray.origin - a;
    const double x = glm::dot(s, h) / det, y = glm::dot(ray.direction, glm::cross(s, u)) / det,
                 at = glm::dot(v, glm::cross(s, u)) / det;
    if (x > -1e-4 && y > -1e-4 && x + y < 1.0001 && std::abs(at - depth) < 1e-4 * depth + 1e-4) return true;
  }
  return false;
}

TEST(FaceCullerAgreement, ImageOfKeptTrianglesIsTheOracles) {
  std::size_t pixels = 0, edges = 0;
  std::vector<cases::Case> scenes;
  for (const char* kind : {"city", "forest", "plant", "layers"})
    scenes.push_back({kind, generate_scene(kind, {.objects = 300, .triangles = 0, .seed = 5})});
  scenes.push_back({"solids", solids_scene(4, 0)});
  for (const cases::Case& c : scenes) {
    const IndexedScene indexed = index_scene(c.scene);
    const Oracle oracle(c.scene);
    const VisibleSet all = VisibleSet::all(c.scene.objects().size());
    for (const std::string& text : contenders()) {
      const auto culler = make_face_culler(text, indexed);
      for (const View& view : cases::hard_views(c.scene, 16, 21, 96)) {
        const bool outside =
            std::none_of(c.scene.objects().begin(), c.scene.objects().end(), [&](const Object& object) {
              const glm::vec3 near(static_cast<float>(2.0 * view.near) + 1e-3f);
              return view.projection == Projection::orthographic ||
                     Aabb{object.bounds.lo - near, object.bounds.hi + near}.contains(glm::vec3(view.eye));
            });
        if (!outside) continue;
        Frame frame;
        FaceSet kept;
        Counters counters;
        oracle.draw(view, frame);
        culler->cull(view, all, kept, counters);
        std::map<MeshId, std::vector<std::uint32_t>> places;
        for (int y = 0; y < frame.height; ++y)
          for (int x = 0; x < frame.width; ++x) {
            const std::size_t at = frame.index(x, y);
            if (frame.object[at] == no_object) continue;
            ++pixels;
            const FaceSet::Part& part = kept.parts()[frame.object[at]];
            const MeshId mesh = c.scene.objects()[part.object].mesh;
            const auto order = culler->order(mesh);
            std::uint32_t place = frame.triangle[at];
            if (!order.empty()) {
              std::vector<std::uint32_t>& inverse = places[mesh];
              if (inverse.empty()) {
                inverse.resize(order.size());
                for (std::uint32_t i = 0; i < order.size(); ++i) inverse[order[i]] = i;
              }
              place = inverse[place];
            }
            if (kept.contains(part, place)) continue;
            ++edges;
            EXPECT_TRUE(kept_at_depth(c.scene, *culler, kept, part, pixel_ray(view, x + 0.5, y + 0.5), frame.depth[at]))
                << text << " on " << c.name << " loses pixel " << x << " " << y << " (" << describe(view) << ")";
          }
      }
    }
  }
  std::printf("%zu pixels, %zu of them on an edge\n", pixels, edges);
  EXPECT_GT(pixels, 100000u);
  EXPECT_LT(edges * 200, pixels);
}

TEST(FaceCullerAgreement, LeavesAloneWhatIsNoSolid) {
  SceneBuilder builder;
  Mesh box = make_box({-1, -1, -1}, {1, 1, 1}), open = box, inverted = box;
  open.triangles.pop_back();
  for (glm::uvec3& t : inverted.triangles) std::swap(t.x, t.y);
  const MeshId meshes[] = {builder.add_mesh(box), builder.add_mesh(open), builder.add_mesh(inverted)};
  for (int i = 0; i < 3; ++i) builder.add_object(meshes[i], cases::at({4.0f * static_cast<float>(i), 0, 0}));
  builder.add_object(meshes[0], cases::at({0, 4, 0}), "glass", {}, false);
  builder.add_object(meshes[0], {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -4, 0}}, "squashed flat");
  builder.add_object(meshes[0], {{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {4, 4, 0}}, "mirrored");
  const Scene scene = builder.build();
  const IndexedScene indexed = index_scene(scene);
  for (const std::string& text : contenders()) {
    const auto culler = make_face_culler(text, indexed);
    FaceSet kept;
    Counters counters;
    View view = look_along({4, 1, 30}, {0, 0, -1});
    view.fov_y = 0.5;
    culler->cull(view, VisibleSet::all(6), kept, counters);
    EXPECT_EQ(culler->solidity(0), Solidity::solid);
    EXPECT_EQ(culler->solidity(1), Solidity::open);
    EXPECT_EQ(culler->solidity(2), Solidity::inverted);
    EXPECT_EQ(kept.count(kept.parts()[1]), 11u) << text;
    for (const std::size_t whole : {2, 3, 4}) EXPECT_EQ(kept.count(kept.parts()[whole]), 12u) << text;
    if (text == "backface" || text == "normal_mask" || text == "cluster_backface") {
      for (const std::size_t culled : {0, 5}) EXPECT_LE(kept.count(kept.parts()[culled]), 10u) << text;
    }
  }
}

TEST(FaceCullerAgreement, AnyObjectsInAnyOrderAndAnyThreads) {
  const Scene scene = solids_scene(9, 10);
  const IndexedScene indexed = index_scene(scene);
  VisibleSet some(scene.objects().size());
  for (const ObjectId id : {7, 2, 5}) some.insert(id);
  for (const std::string& text : contenders()) {
    std::vector<std::vector<bool>> answers;
    for (const int threads : {1, 2}) {
      const ThreadLimit limit(threads);
      const auto culler = make_face_culler(text, indexed);
      FaceSet kept;
      Counters counters;
      for (const View& view : cases::hard_views(scene, 3, 2)) culler->cull(view, some, kept, counters);
      ASSERT_EQ(kept.parts().size(), 3u);
      EXPECT_EQ(kept.parts()[0].object, 7u);
      EXPECT_EQ(kept.parts()[1].object, 2u);
      std::vector<bool>& bits = answers.emplace_back();
      for (const FaceSet::Part& part : kept.parts())
        for (std::size_t i = 0; i < part.triangles; ++i) bits.push_back(kept.contains(part, i));
      EXPECT_GT(culler->bytes(), 0u);
    }
    EXPECT_EQ(answers[0], answers[1]) << text;
  }
}

TEST(FaceCullerAgreement, EmptyScene) {
  const Scene scene = SceneBuilder().build();
  const IndexedScene indexed = index_scene(scene);
  for (const std::string& text : contenders()) {
    FaceSet kept;
    Counters counters;
    make_face_culler(text, indexed)->cull(View(), VisibleSet::all(0), kept, counters);
    EXPECT_EQ(kept.count(), 0u);
  }
}

}  // namespace
}  // namespace sightline
