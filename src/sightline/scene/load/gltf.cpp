// glTF 2.0 into a scene: walks the nodes of the default scene; an object is a primitive of a node's mesh.
// Promise: any depth of nesting; cycles and nodes with two parents are refused; transforms are composed in double.
// Source: glTF 2.0 specification, section 3.5.3 (transformations).
#include <algorithm>
#include <cmath>
#include <string>

#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/gltf_document.hpp"
#include "sightline/scene/load/gltf_mesh.hpp"
#include "sightline/scene/load/gltf_node.hpp"
#include "sightline/scene/load/readers.hpp"

namespace sightline {
namespace {

/// Many more than any renderer takes, few enough to hold: 1.3 GB of objects.
constexpr std::size_t most_objects = std::size_t{1} << 24;

class GltfReader {
 public:
  explicit GltfReader(GltfDocument& document)
      : document_(document), meshes_(document, builder_), visited_(document.count("nodes")) {}

  LoadedScene read() {
    check_object_count();
    walk(roots());
    warn_of_unused();
    LoadedScene loaded;
    loaded.scene = builder_.build();
    loaded.warnings = document_.warnings();
    loaded.cameras = std::move(cameras_);
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

  /// So that a small file, in which many nodes share a mesh of many primitives, cannot ask for all memory.
  void check_object_count() {
    std::uint64_t objects = 0;
    for (std::size_t i = 0; i < visited_.size(); ++i) {
      const JsonObject node = document_.item("nodes", i);
      const auto mesh = node.reference("mesh", document_.count("meshes"));
      if (!mesh) continue;
      objects += document_.item("meshes", *mesh).count("primitives") * instance_count(document_, node);
      if (objects > most_objects) node.fail("the file has more than " + std::to_string(most_objects) + " objects");
    }
    document_.spend(objects * sizeof(Object), document_.root());
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
      const glm::dmat4 world = visit.parent * node_matrix(node);
      add_objects(node, visit.node, world);
      add_camera(node, visit.node, world);
      push(node.references("children", visited_.size()), world);
    }
  }

  void add_objects(const JsonObject& node, std::size_t index, const glm::dmat4& world) {
    const auto mesh = node.reference("mesh", document_.count("meshes"));
    if (!mesh) return;
    const std::span<const GltfMeshes::Part> parts = meshes_.parts(*mesh);
    const std::string name = object_name(node, index, *mesh);
    for (const glm::dmat4& instance : instance_matrices(document_, node)) {
      const Affine transform = finite_affine(node, world * instance);
      for (const GltfMeshes::Part& part : parts) {
        document_.spend(name.size(), node);
        builder_.add_object(part.mesh, transform, name, {static_cast<std::int32_t>(index), part.primitive},
                            part.opaque);
      }
    }
  }

  static Affine finite_affine(const JsonObject& node, const glm::dmat4& world) {
    const Affine transform = to_affine(world);
    for (int i = 0; i < 12; ++i) {
      if (!std::isfinite(transform[i / 3][i % 3])) node.fail("its world transform is not finite");
    }
    return transform;
  }

  void add_camera(const JsonObject& node, std::size_t index, const glm::dmat4& world) {
    const auto number = node.reference("camera", document_.count("cameras"));
    if (!number) return;
    const JsonObject camera = document_.item("cameras", *number);
    std::string name = node.text("name");
    if (name.empty()) name = camera.text("name");
    if (name.empty()) name = "node " + std::to_string(index);
    cameras_.push_back({name, camera_view(camera, world)});
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
  std::vector<LoadedScene::NamedView> cameras_;
};

}  // namespace

LoadedScene read_gltf(const std::filesystem::path& file, Bytes bytes) {
  GltfDocument document(file, std::move(bytes));
  return GltfReader(document).read();
}

}  // namespace sightline
