#include "sightline/scene/scene.hpp"

#include <cmath>
#include <limits>

#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/scene/topology.hpp"

namespace sightline {
namespace {

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void check_mesh(const Mesh& mesh, std::size_t index) {
  const std::string position = "mesh " + std::to_string(index) + (mesh.name.empty() ? "" : " (" + mesh.name + ")");
  for (const glm::vec3& p : mesh.positions)
    if (!finite(p)) throw InputError("", position, "a vertex position is not finite");
  const std::size_t n = mesh.positions.size();
  for (const glm::uvec3& t : mesh.triangles)
    if (t.x >= n || t.y >= n || t.z >= n)
      throw InputError("", position, "a triangle refers to a vertex beyond the last of " + std::to_string(n));
}

void check_transform(const Affine& transform, std::size_t object) {
  for (int c = 0; c < 4; ++c)
    if (!finite(transform[c])) throw InputError("", "object " + std::to_string(object), "its transform is not finite");
}

void check_reach(const Aabb& bounds, std::size_t object) {
  if (!(static_cast<double>(reach(bounds)) <= largest_distance))  // also what is not finite any more
    throw InputError("", "object " + std::to_string(object), "it reaches farther than 1e15 m from the origin");
}

/// Bounds of the used vertices under an affine map, widened by the rounding error of mapping them in float.
Aabb transformed_bounds(const Mesh& mesh, const Affine& m) {
  if (mesh.bounds.empty()) return {};
  Aabb box;
  for (const glm::vec3& p : mesh.positions) box.extend(transform_point(m, p));
  const glm::vec3 size = glm::max(glm::abs(mesh.bounds.lo), glm::abs(mesh.bounds.hi));
  const glm::vec3 terms = glm::abs(m[0]) * size.x + glm::abs(m[1]) * size.y + glm::abs(m[2]) * size.z + glm::abs(m[3]);
  const glm::vec3 slack = terms * (4.0f * std::numeric_limits<float>::epsilon());
  return {box.lo - slack, box.hi + slack};
}

/// Drops vertices that no triangle uses, so that bounds are those of the surface.
void drop_unused_vertices(Mesh& mesh) {
  std::vector<std::uint32_t> renamed(mesh.positions.size(), no_object);
  std::uint32_t used = 0;
  for (const glm::uvec3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      if (renamed[t[k]] == no_object) {
        renamed[t[k]] = 0;
        ++used;
      }
  if (used == mesh.positions.size()) return;
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (renamed[i] == no_object) continue;
    renamed[i] = next;
    mesh.positions[next++] = mesh.positions[i];
  }
  mesh.positions.resize(next);
  for (glm::uvec3& t : mesh.triangles) t = {renamed[t.x], renamed[t.y], renamed[t.z]};
}

}  // namespace

std::vector<Aabb> Scene::object_bounds() const {
  std::vector<Aabb> boxes;
  boxes.reserve(objects_.size());
  for (const Object& object : objects_) boxes.push_back(object.bounds);
  return boxes;
}

void Scene::move_objects(std::span<const Move> moves) {
  std::vector<Aabb> bounds;
  bounds.reserve(moves.size());
  for (const Move& move : moves) {
    if (move.object >= objects_.size())
      throw InputError("", "object " + std::to_string(move.object), "cannot be moved: it does not exist");
    check_transform(move.transform, move.object);
    bounds.push_back(transformed_bounds(meshes_[objects_[move.object].mesh], move.transform));
    check_reach(bounds.back(), move.object);
  }
  for (std::size_t i = 0; i < moves.size(); ++i) {
    Object& object = objects_[moves[i].object];
    object.transform = moves[i].transform;
    object.bounds = bounds[i];
  }
  bounds_ = {};
  for (const Object& object : objects_) bounds_.extend(object.bounds);
}

MeshId SceneBuilder::add_mesh(Mesh mesh) {
  scene_.meshes_.push_back(std::move(mesh));
  return static_cast<MeshId>(scene_.meshes_.size() - 1);
}

ObjectId SceneBuilder::add_object(MeshId mesh, const Affine& transform, std::string_view name, Source source,
                                  bool opaque) {
  scene_.objects_.push_back({mesh, opaque, transform, {}});
  scene_.sources_.push_back(source);
  scene_.names_ += name;
  scene_.name_ends_.push_back(static_cast<std::uint32_t>(scene_.names_.size()));
  return static_cast<ObjectId>(scene_.objects_.size() - 1);
}

std::uint32_t SceneBuilder::add_cell(Cell cell) {
  scene_.cells_.push_back(std::move(cell));
  return static_cast<std::uint32_t>(scene_.cells_.size() - 1);
}

void SceneBuilder::add_portal(Portal portal) { scene_.portals_.push_back(std::move(portal)); }

Scene SceneBuilder::build() {
  for (std::size_t i = 0; i < scene_.meshes_.size(); ++i) check_mesh(scene_.meshes_[i], i);
  for (std::size_t i = 0; i < scene_.objects_.size(); ++i) {
    const Object& object = scene_.objects_[i];
    const std::string position = "object " + std::to_string(i);
    if (object.mesh >= scene_.meshes_.size()) throw InputError("", position, "refers to a mesh that does not exist");
    check_transform(object.transform, i);
  }
  for (const Cell& cell : scene_.cells_)
    for (const ObjectId id : cell.objects)
      if (id >= scene_.objects_.size()) throw InputError("", "cell " + cell.name, "refers to an unknown object");
  for (const Portal& portal : scene_.portals_)
    if (portal.cells[0] >= scene_.cells_.size() || portal.cells[1] >= scene_.cells_.size())
      throw InputError("", "portal", "refers to an unknown cell");

  parallel_blocks(scene_.meshes_.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Mesh& mesh = scene_.meshes_[i];
      drop_unused_vertices(mesh);
      mesh.bounds = {};
      for (const glm::vec3& p : mesh.positions) mesh.bounds.extend(p);
      mesh.closed = is_closed(mesh.positions, mesh.triangles);
    }
  });
  parallel_blocks(scene_.objects_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Object& object = scene_.objects_[i];
      object.bounds = transformed_bounds(scene_.meshes_[object.mesh], object.transform);
    }
  });
  scene_.bounds_ = {};
  scene_.triangle_count_ = 0;
  for (std::size_t i = 0; i < scene_.objects_.size(); ++i) {
    const Object& object = scene_.objects_[i];
    check_reach(object.bounds, i);
    scene_.bounds_.extend(object.bounds);
    scene_.triangle_count_ += scene_.meshes_[object.mesh].triangles.size();
  }
  // Growing arrays leave up to as much again unused; a million objects are to stay small.
  const auto shrink = [](auto& array) {
    if (array.capacity() > array.size() + array.size() / 8) array.shrink_to_fit();
  };
  shrink(scene_.objects_);
  shrink(scene_.sources_);
  shrink(scene_.names_);
  shrink(scene_.name_ends_);
  Scene finished = std::move(scene_);
  scene_ = Scene();
  return finished;
}

}  // namespace sightline
