#include "faces_experiments.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "sightline/geometry/cluster_tree.hpp"
#include "sightline/geometry/normal_mask.hpp"
#include "sightline/geometry/obb.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/scene/mesh_eye.hpp"
#include "sightline/scene/solid.hpp"

namespace sightline::cli {
namespace {

/// The solid object with the most triangles.
ObjectId largest_solid(const Scene& scene) {
  ObjectId best = no_object;
  std::size_t most = 0;
  for (ObjectId id = 0; id < scene.objects().size(); ++id)
    if (scene.mesh_of(id).triangles.size() > most && solidity_of(scene.mesh_of(id)) == Solidity::solid) {
      best = id;
      most = scene.mesh_of(id).triangles.size();
    }
  if (best == no_object) throw InputError("the scene has no solid object (closed, turned outwards)");
  return best;
}

glm::dvec3 corner(const Mesh& mesh, std::uint32_t triangle, int k, const glm::dvec3& origin) {
  return glm::dvec3(mesh.positions[mesh.triangles[triangle][k]]) - origin;
}

std::vector<FacePlane> planes_of(const Mesh& mesh, const ClusterTree& tree, const ClusterRange& range) {
  const glm::dvec3 origin(mesh.bounds.centre());
  std::vector<FacePlane> planes;
  for (std::uint32_t i = range.begin; i < range.end; ++i) {
    const std::uint32_t t = tree.order[i];
    planes.push_back(face_plane(corner(mesh, t, 0, origin), corner(mesh, t, 1, origin), corner(mesh, t, 2, origin)));
  }
  return planes;
}

/// A rotation (rows are the axes) that takes `from` to `to`, both unit.
glm::dmat3 turning(const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 axis = glm::cross(from, to);
  if (glm::length(axis) < 1e-9) return glm::dmat3(1.0);
  return glm::mat3_cast(glm::angleAxis(std::acos(std::clamp(glm::dot(from, to), -1.0, 1.0)), glm::normalize(axis)));
}

constexpr std::array<const char*, 4> frame_names{"axes of the mesh", "mean normal along the diagonal",
                                                 "mean normal along an axis", "principal axes of the normals"};

glm::dmat3 frame_of(std::size_t kind, const std::vector<FacePlane>& planes) {
  glm::dvec3 mean(0.0);
  std::vector<glm::vec3> normals;
  for (const FacePlane& plane : planes) {
    mean += plane.normal;
    normals.emplace_back(plane.normal);
  }
  mean = glm::length(mean) > 0.0 ? glm::normalize(mean) : glm::dvec3(0, 0, 1);
  if (kind == 1) return turning(mean, glm::normalize(glm::dvec3(1, 1, 1)));
  if (kind == 2) return turning(mean, {0, 0, 1});
  if (kind == 3) return glm::transpose(glm::dmat3(pca_box(normals).axes));
  return glm::dmat3(1.0);
}

}  // namespace

std::vector<FrameResult> rotated_frames(const Scene& scene, std::span<const View> views) {
  std::vector<FrameResult> results(frame_names.size());
  std::vector<double> culled(results.size()), probable(results.size());
  double back = 0.0, clusters = 0.0;
  Random random(1);
  for (std::size_t m = 0; m < scene.meshes().size() && clusters < 4000; ++m) {
    const Mesh& mesh = scene.meshes()[m];
    if (solidity_of(mesh) != Solidity::solid) continue;
    const auto object =
        std::find_if(scene.objects().begin(), scene.objects().end(), [&](const Object& o) { return o.mesh == m; });
    if (object == scene.objects().end()) continue;
    const ClusterTree tree = build_cluster_tree(mesh.positions, mesh.triangles, mesh.bounds.centre());
    const auto leaves = leaf_clusters(tree);
    const std::size_t stride = std::max<std::size_t>(1, leaves.size() / 1000);
    for (std::size_t i = 0; i < leaves.size(); i += stride) {
      const std::vector<FacePlane> planes = planes_of(mesh, tree, leaves[i]);
      const glm::dvec3 place(leaves[i].cluster.c);
      ++clusters;
      std::vector<glm::vec3> eyes;
      for (const View& view : views)
        if (const MeshEye eye = mesh_eye(view, *object, mesh); eye.valid && eye.eye.w > 0.0f)
          eyes.emplace_back(eye.eye);
      const std::size_t seen_from = eyes.size();
      const double field = 2.0 * glm::length(glm::dvec3(mesh.bounds.extent()));
      for (int k = 0; k < 32; ++k) eyes.emplace_back(place + field * random.uniform() * random.direction());
      for (std::size_t e = 0; e < seen_from; ++e)
        for (const FacePlane& plane : planes)
          back += glm::dot(plane.normal, glm::dvec3(eyes[e])) <= plane.offset ? 1.0 : 0.0;
      for (std::size_t kind = 0; kind < frame_names.size(); ++kind) {
        const glm::dmat3 frame = frame_of(kind, planes);
        std::vector<FacePlane> turned = planes;
        for (FacePlane& plane : turned) plane.normal = frame * plane.normal;
        // The same nine origins would cost the same; here all frames have the one that the tree chose.
        const NormalCluster cluster = make_cluster(turned, glm::vec3(frame * place));
        for (std::size_t e = 0; e < eyes.size(); ++e) {
          const bool in = turns_back(cluster, glm::vec4(glm::vec3(frame * glm::dvec3(eyes[e])), 1.0f), 1e-6f);
          if (!in) continue;
          if (e < seen_from)
            culled[kind] += static_cast<double>(planes.size());
          else
            probable[kind] += 1.0 / 32.0;
        }
      }
    }
  }
  for (std::size_t kind = 0; kind < results.size(); ++kind)
    results[kind] = {frame_names[kind], clusters > 0 ? probable[kind] / clusters : 0.0,
                     back > 0 ? culled[kind] / back : 0.0};
  return results;
}

namespace {

using Colour = std::array<std::uint8_t, 3>;

void fill(Picture& picture, int x0, int y0, int x1, int y1, const Colour& colour) {
  for (int y = std::max(0, y0); y < std::min(y1, picture.height); ++y)
    for (int x = std::max(0, x0); x < std::min(x1, picture.width); ++x)
      std::copy(colour.begin(), colour.end(),
                picture.rgb.begin() + 3 * (static_cast<std::ptrdiff_t>(y) * picture.width + x));
}

Picture blank(int width, int height, const Colour& colour) {
  Picture picture{width, height,
                  std::vector<std::uint8_t>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3)};
  fill(picture, 0, 0, width, height, colour);
  return picture;
}

}  // namespace

Picture draw_mask(const Scene& scene, const View& view) {
  const ObjectId id = largest_solid(scene);
  const Object& object = scene.objects()[id];
  const Mesh& mesh = scene.mesh_of(id);
  const DirectionCube cube(16);
  // The object from where it fills the view: beside, the mask of that view.
  View near = view;
  near.width = 480;
  near.height = 480;
  near.eye = glm::dvec3(glm::vec3(glm::dvec3(object.bounds.centre()) -
                                  0.9 / std::tan(0.5 * view.fov_y) * 0.62 *
                                      glm::length(glm::dvec3(object.bounds.extent())) * view_direction(view)));
  View behind = near;  // the same mask looked at from the other side, where its back-facing classes are
  behind.eye = 2.0 * glm::dvec3(object.bounds.centre()) - near.eye;
  behind.orientation = near.orientation * glm::angleAxis(3.14159265358979323846, glm::dvec3(0, 1, 0));
  glm::dmat3 inverse;
  if (!inverse_linear(object.transform, inverse)) throw InputError("the largest solid object has a singular transform");
  std::vector<glm::vec3> directions;
  for (const double y : {0.0, 1.0})
    for (const double x : {0.0, 1.0})
      directions.emplace_back(glm::normalize(inverse * pixel_ray(near, x * near.width, y * near.height).direction));
  const BackMask mask = back_mask(cube, directions, 4e-6f);
  const auto culled = [&](int normal_class) {
    const PolygonNormalMask bits = polygon_normal_mask(normal_class);
    return (mask[bits.byte_offset] & bits.bit_mask) != 0;
  };
  constexpr Colour background{245, 245, 245}, back{60, 160, 70}, front{205, 205, 210}, line{255, 255, 255};
  Picture picture = blank(980, 840, background);
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(mesh), object.transform);
  const Scene alone = builder.build();
  const Oracle oracle(alone);
  for (int half = 0; half < 2; ++half) {
    Frame frame;
    const View& from = half == 0 ? near : behind;
    oracle.draw(from, frame);
    const Picture shaded = paint(alone, from, frame, Show::shaded);
    for (int y = 0; y < 480; ++y)
      for (int x = 0; x < 480; ++x) {
        const std::size_t at = frame.index(x, y);
        if (frame.object[at] == no_object) continue;
        const FacePlane plane = face_plane(corner(alone.meshes()[0], frame.triangle[at], 0, {}),
                                           corner(alone.meshes()[0], frame.triangle[at], 1, {}),
                                           corner(alone.meshes()[0], frame.triangle[at], 2, {}));
        const Colour& tint = plane.height > 0.0 && culled(cube.class_of(plane.normal)) ? back : front;
        Colour colour{};
        for (std::size_t c = 0; c < 3; ++c)
          colour[c] = static_cast<std::uint8_t>(shaded.rgb[3 * at + c] * tint[c] / 255);
        fill(picture, half * 500 + x, y, half * 500 + x + 1, y + 1, colour);
      }
  }
  // The cube's faces in two rows of three: +x +y +z, -x -y -z.
  constexpr int cell = 10;
  for (int face = 0; face < 6; ++face)
    for (int row = 0; row < cube.n(); ++row)
      for (int column = 0; column < cube.n(); ++column) {
        const int x = 230 + (face / 2) * (cube.n() * cell + 20) + column * cell,
                  y = 490 + (face % 2) * (cube.n() * cell + 12) + row * cell;
        fill(picture, x, y, x + cell, y + cell, line);
        fill(picture, x, y, x + cell - 1, y + cell - 1,
             culled((face * cube.n() + row) * cube.n() + column) ? back : front);
      }
  return picture;
}

namespace {

/// Corners of {e in box : turns_back(e)}: where three of its planes meet.
std::vector<glm::vec3> volume_corners(const NormalCluster& cluster, const Aabb& box) {
  std::vector<glm::dvec4> planes;  // inside: n . e <= w
  for (int octant = 0; octant < 8; ++octant) {
    const glm::dvec3 n((octant & 1) != 0 ? cluster.m.x : cluster.n.x, (octant & 2) != 0 ? cluster.m.y : cluster.n.y,
                       (octant & 4) != 0 ? cluster.m.z : cluster.n.z);
    planes.emplace_back(n, static_cast<double>(cluster.d) + glm::dot(n, glm::dvec3(cluster.c)));
  }
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec4 plane(0.0);
    plane[axis] = 1.0;
    plane.w = static_cast<double>(box.hi[axis]);
    planes.push_back(plane);
    plane[axis] = -1.0;
    plane.w = -static_cast<double>(box.lo[axis]);
    planes.push_back(plane);
  }
  std::vector<glm::vec3> corners;
  const double slack = 1e-6 * glm::length(glm::dvec3(box.extent()));
  for (std::size_t a = 0; a < planes.size(); ++a)
    for (std::size_t b = a + 1; b < planes.size(); ++b)
      for (std::size_t c = b + 1; c < planes.size(); ++c) {
        const glm::dmat3 rows =
            glm::transpose(glm::dmat3(glm::dvec3(planes[a]), glm::dvec3(planes[b]), glm::dvec3(planes[c])));
        if (std::abs(glm::determinant(rows)) < 1e-9) continue;
        const glm::dvec3 p = glm::inverse(rows) * glm::dvec3(planes[a].w, planes[b].w, planes[c].w);
        if (std::all_of(planes.begin(), planes.end(),
                        [&](const glm::dvec4& q) { return glm::dot(glm::dvec3(q), p) <= q.w + slack; }))
          corners.emplace_back(p);
      }
  return corners;
}

}  // namespace

Picture draw_culling_volume(const Scene& scene) {
  const Mesh& mesh = scene.mesh_of(largest_solid(scene));
  ClusterTreeConfig config;
  config.leaf = static_cast<int>(std::clamp<std::size_t>(mesh.triangles.size() / 60, 8, 4096));
  config.cost_test = 0.0;
  config.position = 1.5;  // more in one place than for culling
  const ClusterTree tree = build_cluster_tree(mesh.positions, mesh.triangles, mesh.bounds.centre(), config);
  const auto leaves = leaf_clusters(tree);
  const glm::vec3 half = 0.5f * mesh.bounds.extent();
  const Aabb viewpoints{-1.3f * half, 1.3f * half};
  // One with a culling volume that is neither everything nor nothing.
  const auto best = std::max_element(leaves.begin(), leaves.end(), [&](const ClusterRange& a, const ClusterRange& b) {
    const auto worth = [&](const ClusterRange& r) {
      return -std::abs(culling_probability(r.cluster, viewpoints) - 0.12);
    };
    return worth(a) < worth(b);
  });
  Mesh rest = mesh, chosen = mesh;
  rest.triangles.clear();
  chosen.triangles.clear();
  for (std::uint32_t i = 0; i < tree.order.size(); ++i)
    (i >= best->begin && i < best->end ? chosen : rest).triangles.push_back(mesh.triangles[tree.order[i]]);
  const ConvexHull hull = convex_hull(volume_corners(best->cluster, viewpoints));
  Mesh volume;
  for (const glm::vec3& p : hull.vertices) volume.positions.push_back(p + mesh.bounds.centre());
  volume.triangles = hull.faces;
  glm::dvec3 normal(0.0);
  for (const FacePlane& plane : planes_of(mesh, tree, *best)) normal += plane.normal;
  const glm::dvec3 side = glm::normalize(
      glm::cross(glm::normalize(normal),
                 std::abs(normal.y) < 0.8 * glm::length(normal) ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
  View view = look_along(glm::dvec3(mesh.bounds.centre()) +
                             2.6 * glm::length(glm::dvec3(half)) * glm::normalize(side + 0.35 * glm::normalize(normal)),
                         -glm::normalize(side + 0.35 * glm::normalize(normal)));
  view.width = 640;
  view.height = 480;
  view.near = 1e-3 * static_cast<double>(glm::length(half));
  view.far = 20.0 * static_cast<double>(glm::length(half));
  Picture sum;
  for (int pass = 0; pass < 2; ++pass) {
    SceneBuilder builder;
    builder.add_object(builder.add_mesh(rest), identity_affine());
    builder.add_object(builder.add_mesh(chosen), identity_affine());
    if (pass == 1) builder.add_object(builder.add_mesh(volume), identity_affine());
    const Scene parts = builder.build();
    Frame frame;
    Oracle(parts).draw(view, frame);
    Picture picture = paint(parts, view, frame, Show::shaded);
    for (std::size_t i = 0; i < frame.object.size(); ++i) {
      const Colour tint = frame.object[i] == 1   ? Colour{255, 60, 50}
                          : frame.object[i] == 2 ? Colour{90, 150, 255}
                                                 : Colour{255, 255, 255};
      for (std::size_t c = 0; c < 3; ++c)
        picture.rgb[3 * i + c] = static_cast<std::uint8_t>(picture.rgb[3 * i + c] * tint[c] / 255);
    }
    if (pass == 0)
      sum = picture;
    else
      for (std::size_t i = 0; i < sum.rgb.size(); ++i)
        sum.rgb[i] = static_cast<std::uint8_t>((sum.rgb[i] + picture.rgb[i]) / 2);
  }
  return sum;
}

}  // namespace sightline::cli
