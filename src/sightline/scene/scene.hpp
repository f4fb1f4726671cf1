// The scene: shared meshes, objects that place them in the world, and what belongs to the space (cells and portals).
// Immutable once built by SceneBuilder. Right-handed, Y up, metres. One ObjectId space for every algorithm.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/geometry/aabb.hpp"
#include "sightline/geometry/affine.hpp"

namespace sightline {

using ObjectId = std::uint32_t;
using MeshId = std::uint32_t;
/// Scenes and eyes reach no farther from the origin, metres: what float arithmetic on squares of coordinates stands.
inline constexpr double largest_distance = 1e15;
/// Near planes lie no nearer to the eye and orthographic views are no smaller, metres, for the same reason.
inline constexpr double smallest_distance = 1e-9;
inline constexpr ObjectId no_object = 0xFFFFFFFFu;

/// Triangles over shared vertices, in the mesh's own space. Counter-clockwise seen from the front.
struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  /// Set by SceneBuilder::build: every edge joins exactly two triangles of opposite direction (checklist 17.01, 17.06).
  bool closed = false;
  /// Set by SceneBuilder::build.
  Aabb bounds;
};

/// Where an object comes from in its file; -1 where the format has no such thing.
struct Source {
  std::int32_t node = -1;
  std::int32_t primitive = -1;
};

/// One instance of a mesh. 80 bytes; its name and source are kept by the Scene.
struct Object {
  MeshId mesh = 0;
  /// False for glass and the like: seen itself, but hides nothing behind it (checklist 1.06).
  bool opaque = true;
  /// Mesh space to world space.
  Affine transform = identity_affine();
  /// World-space bounds of the transformed vertices, rounded outwards. Set by SceneBuilder::build.
  Aabb bounds;
};

/// A convex or box-like region of free space (a room), with the objects that can be seen in it (checklist 25.03).
struct Cell {
  std::string name;
  Aabb bounds;
  std::vector<ObjectId> objects;
};

/// A planar polygon through which one cell is seen from another (checklist 25.01). World space.
struct Portal {
  std::uint32_t cells[2] = {0, 0};
  std::vector<glm::vec3> polygon;
};

class Scene {
 public:
  [[nodiscard]] std::span<const Mesh> meshes() const { return meshes_; }
  [[nodiscard]] std::span<const Object> objects() const { return objects_; }
  [[nodiscard]] const Mesh& mesh_of(ObjectId id) const { return meshes_[objects_[id].mesh]; }
  [[nodiscard]] std::string_view name(ObjectId id) const {
    return std::string_view(names_).substr(name_ends_[id], name_ends_[id + 1] - name_ends_[id]);
  }
  [[nodiscard]] Source source(ObjectId id) const { return sources_[id]; }
  [[nodiscard]] std::span<const Cell> cells() const { return cells_; }
  [[nodiscard]] std::span<const Portal> portals() const { return portals_; }
  /// World bounds of all objects; empty for an empty scene.
  [[nodiscard]] const Aabb& bounds() const { return bounds_; }
  /// Triangles over all objects, instances counted each.
  [[nodiscard]] std::uint64_t triangle_count() const { return triangle_count_; }
  /// World bounds of every object, by id.
  [[nodiscard]] std::vector<Aabb> object_bounds() const;

  /// An object and where it is to be: mesh space to world space.
  struct Move {
    ObjectId object;
    Affine transform;
  };
  /// Moves objects; their bounds and the scene's follow. An index over the scene wants refit(), a culler
  /// Culler::follow_scene(). Throws InputError, with nothing moved: an unknown object, a transform that is not finite
  /// or takes its object farther than 1e15 m from the origin. O(vertices of those moved + objects).
  void move_objects(std::span<const Move> moves);

 private:
  friend class SceneBuilder;
  std::vector<Mesh> meshes_;
  std::vector<Object> objects_;
  std::vector<Source> sources_;
  std::string names_;                         // all names in one string: a million objects cost no million allocations
  std::vector<std::uint32_t> name_ends_{0u};  // name i is [name_ends_[i], name_ends_[i + 1])
  std::vector<Cell> cells_;
  std::vector<Portal> portals_;
  Aabb bounds_;
  std::uint64_t triangle_count_ = 0;
};

/// Collects the parts of a scene; build() checks them and computes what follows from them.
class SceneBuilder {
 public:
  /// Takes positions and triangles; `closed` and `bounds` are computed later.
  MeshId add_mesh(Mesh mesh);
  ObjectId add_object(MeshId mesh, const Affine& transform, std::string_view name = {}, Source source = {},
                      bool opaque = true);
  std::uint32_t add_cell(Cell cell);
  void add_portal(Portal portal);

  [[nodiscard]] std::size_t object_count() const { return scene_.objects_.size(); }
  [[nodiscard]] std::size_t mesh_count() const { return scene_.meshes_.size(); }

  /// The finished scene; the builder is empty afterwards.
  /// Throws InputError: an index beyond the vertices, a coordinate or transform that is not finite, an unknown mesh or
  /// cell.
  Scene build();

 private:
  Scene scene_;
};

}  // namespace sightline
