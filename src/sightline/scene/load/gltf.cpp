// glTF 2.0 into a scene: walks the nodes of the default scene; an object is a primitive of a node's mesh.
// Promise: any depth of nesting; cycles and nodes with two parents are refused; transforms are composed in double.
// Source: glTF 2.0 specification, section 3.5.3 (transformations).
#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <string>

#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/gltf_document.hpp"
#include "sightline/scene/load/gltf_mesh.hpp"
#include "sightline/scene/load/readers.hpp"

namespace sightline {
namespace {

/// Many more than any renderer takes, few enough to hold: 1.3 GB of objects.
constexpr std::size_t most_objects = std::size_t{1} << 24;

glm::dmat4 affine_matrix(const JsonObject& node, std::span<const double, 16> values) {
  glm::dmat4 matrix;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) matrix[column][row] = values[static_cast<std::size_t>(column * 4 + row)];
  }
  const glm::dvec4 last_row{matrix[0][3], matrix[1][3], matrix[2][3], matrix[3][3] - 1.0};
  if (glm::length(last_row) > 1e-6) node.fail("matrix", "its last row must be 0 0 0 1");
  for (int column = 0; column < 4; ++column) matrix[column][3] = column == 3 ? 1.0 : 0.0;
  return matrix;
}

glm::dmat4 compose(const glm::dvec3& translation, const glm::dquat& rotation, const glm::dvec3& scale) {
  const glm::dmat3 axes = glm::mat3_cast(rotation);
  return {glm::dvec4(axes[0] * scale.x, 0.0), glm::dvec4(axes[1] * scale.y, 0.0), glm::dvec4(axes[2] * scale.z, 0.0),
          glm::dvec4(translation, 1.0)};
}

/// The transform of a node relative to its parent.
glm::dmat4 local_matrix(const JsonObject& node) {
  std::array<double, 16> matrix{};
  if (node.numbers("matrix", matrix)) return affine_matrix(node, matrix);
  std::array<double, 3> t{0.0, 0.0, 0.0}, s{1.0, 1.0, 1.0};
  std::array<double, 4> r{0.0, 0.0, 0.0, 1.0};
  node.numbers("translation", t);
  node.numbers("scale", s);
  node.numbers("rotation", r);
  const glm::dquat rotation(r[3], r[0], r[1], r[2]);
  const double length = glm::length(rotation);
  if (!(length > 0.0) || !std::isfinite(length)) node.fail("rotation", "is no rotation");
  return compose({t[0], t[1], t[2]}, rotation / length, {s[0], s[1], s[2]});
}

class GltfReader {
 public:
  explicit GltfReader(GltfDocument& document)
      : document_(document), meshes_(document, builder_), visited_(document.count("nodes")) {}

  LoadedScene read() {
    walk(roots());
    warn_of_unused();
    LoadedScene loaded;
    loaded.scene = builder_.build();
    loaded.warnings = document_.warnings();
    return loaded;
  }

 private:
  struct Visit {
    std::size_t node;
    glm::dmat4 parent;
  };

  std::vector<std::size_t> roots() const {
    const std::size_t scenes = document_.count("scenes");
    if (scenes > 0) {
      const std::size_t scene = document_.root().reference("scene", scenes).value_or(0);
      return document_.item("scenes", scene).references("nodes", visited_.size());
    }
    std::vector<bool> is_child(visited_.size());
    for (std::size_t i = 0; i < visited_.size(); ++i) {
      for (const std::size_t child : document_.item("nodes", i).references("children", visited_.size()))
        is_child[child] = true;
    }
    std::vector<std::size_t> nodes;
    for (std::size_t i = 0; i < visited_.size(); ++i) {
      if (!is_child[i]) nodes.push_back(i);
    }
    return nodes;
  }

  /// Depth first, children in their order, without recursion.
  void walk(const std::vector<std::size_t>& roots) {
    std::vector<Visit> pending;
    const auto push = [&](const std::vector<std::size_t>& nodes, const glm::dmat4& parent) {
      for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) pending.push_back({*node, parent});
    };
    push(roots, glm::dmat4(1.0));
    while (!pending.empty()) {
      const Visit visit = pending.back();
      pending.pop_back();
      const JsonObject node = document_.item("nodes", visit.node);
      if (visited_[visit.node]) node.fail("is reached twice: a node must have one parent and not be its own ancestor");
      visited_[visit.node] = true;
      const glm::dmat4 world = visit.parent * local_matrix(node);
      add_objects(node, visit.node, world);
      push(node.references("children", visited_.size()), world);
    }
  }

  void add_objects(const JsonObject& node, std::size_t index, const glm::dmat4& world) {
    const auto mesh = node.reference("mesh", document_.count("meshes"));
    if (!mesh) return;
    add_instance(node, index, *mesh, world);
  }

  void add_instance(const JsonObject& node, std::size_t index, std::size_t mesh, const glm::dmat4& world) {
    const std::span<const GltfMeshes::Part> parts = meshes_.parts(mesh);
    const std::string name = object_name(node, index, mesh);
    const Affine transform = to_affine(world);
    for (int column = 0; column < 4; ++column) {
      const glm::vec3& v = transform[column];
      if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
        node.fail("its world transform is not finite");
    }
    if (parts.size() > most_objects - builder_.object_count()) {
      node.fail("the file has more than " + std::to_string(most_objects) + " objects");
    }
    for (const GltfMeshes::Part& part : parts) {
      document_.spend(sizeof(Object) + name.size(), node);
      builder_.add_object(part.mesh, transform, name, {static_cast<std::int32_t>(index), part.primitive}, part.opaque);
    }
  }

  std::string object_name(const JsonObject& node, std::size_t index, std::size_t mesh) const {
    if (const std::string& name = node.text("name"); !name.empty()) return name;
    if (const std::string& name = document_.item("meshes", mesh).text("name"); !name.empty()) return name;
    return "node " + std::to_string(index);
  }

  void warn_of_unused() {
    for (const std::string_view list : {"animations", "skins"}) {
      const std::size_t count = document_.count(list);
      if (count > 0) document_.warn(std::to_string(count) + " " + std::string(list) + " are not used");
    }
  }

  GltfDocument& document_;
  SceneBuilder builder_;
  GltfMeshes meshes_;
  std::vector<bool> visited_;
};

}  // namespace

LoadedScene read_gltf(const std::filesystem::path& file, Bytes bytes) {
  GltfDocument document(file, std::move(bytes));
  return GltfReader(document).read();
}

}  // namespace sightline
