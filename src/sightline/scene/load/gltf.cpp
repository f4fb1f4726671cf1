// glTF 2.0 into a scene: walks the nodes of the default scene; an object is a primitive of a node's mesh.
// Promise: any depth of nesting; cycles and nodes with two parents are refused; transforms are composed in double.
// Source: glTF 2.0 specification, section 3.5.3 (transformations).
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/gltf_animation.hpp"
#include "sightline/scene/load/gltf_document.hpp"
#include "sightline/scene/load/gltf_mesh.hpp"
#include "sightline/scene/load/gltf_node.hpp"
#include "sightline/scene/load/readers.hpp"

namespace sightline {
namespace {

/// Many more than any renderer takes, few enough to hold: 1.3 GB of objects.
constexpr std::size_t most_objects = std::size_t{1} << 24;
/// A scene counts the bytes of its names in 32 bits.
constexpr std::uint64_t most_name_bytes = 0xFFFFFFFFu;

class GltfReader {
 public:
  explicit GltfReader(GltfDocument& document)
      : document_(document), meshes_(document, builder_), visited_(document.count("nodes")) {}

  LoadedScene read() {
    check_object_count();
    walk(roots());
    move_cameras();
    warn_of_unused();
    LoadedScene loaded;
    loaded.scene = builder_.build();
    loaded.warnings = document_.warnings();
    loaded.cameras = std::move(cameras_);
    loaded.moving_cameras = std::move(moving_cameras_);
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
    parents_.assign(visited_.size(), no_node);
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
      const std::vector<std::size_t> children = node.references("children", visited_.size());
      for (const std::size_t child : children) parents_[child] = visit.node;
      push(children, world);
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
        name_bytes_ += name.size();
        if (name_bytes_ > most_name_bytes) node.fail("the names of all objects together are longer than 4 GiB");
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
    std::string name = one_line(node.text("name"));
    if (name.empty()) name = one_line(camera.text("name"));
    if (name.empty()) name = "node " + std::to_string(index);
    cameras_.push_back({name, camera_view(camera, world)});
    camera_nodes_.push_back(index);
  }

  /// Cameras whose node, or one above it, is animated.
  void move_cameras() {
    if (document_.count("animations") == 0 || cameras_.empty()) return;
    std::size_t channels = 0;
    const std::map<std::size_t, GltfMotion> motions = read_motions(document_, channels);
    std::set<std::size_t> used;
    for (std::size_t i = 0; i < cameras_.size(); ++i) move_camera(i, motions, used);
    animations_used_ = !used.empty();
    animations_all_used_ = used.size() == motions.size();
  }

  void move_camera(std::size_t camera, const std::map<std::size_t, GltfMotion>& motions, std::set<std::size_t>& used) {
    auto chain = std::make_shared<std::vector<GltfLink>>();
    double begin = std::numeric_limits<double>::infinity(), end = -begin;
    for (std::size_t node = camera_nodes_[camera]; node != no_node; node = parents_[node]) {
      const auto motion = motions.find(node);
      chain->push_back(read_link(document_.item("nodes", node), motion == motions.end() ? nullptr : &motion->second));
      if (!chain->back().motion.moves()) continue;
      used.insert(node);
      for (const auto* track : {&motion->second.translation, &motion->second.rotation, &motion->second.scale}) {
        if (!*track) continue;
        begin = std::min(begin, static_cast<double>((*track)->times.front()));
        end = std::max(end, static_cast<double>((*track)->times.back()));
      }
    }
    if (!(begin <= end)) return;
    std::reverse(chain->begin(), chain->end());
    const auto at = [chain, lens = cameras_[camera].view](double seconds) {
      glm::dmat4 world(1.0);
      for (const GltfLink& link : *chain) world = world * link.at(seconds);
      return moved_view(lens, world);
    };
    moving_cameras_.push_back({cameras_[camera].name, begin, end, at});
  }

  std::string object_name(const JsonObject& node, std::size_t index, std::size_t mesh) const {
    if (const std::string name = one_line(node.text("name")); !name.empty()) return name;
    if (const std::string name = one_line(document_.item("meshes", mesh).text("name")); !name.empty()) return name;
    return "node " + std::to_string(index);
  }

  void warn_of_unused() {
    for (const std::string_view list : {"animations", "skins"}) {
      const std::size_t count = document_.count(list);
      if (list == "animations" && animations_used_) {
        if (!animations_all_used_) document_.warn("of the animations only what moves cameras is used");
        continue;
      }
      if (count > 0) document_.warn(std::to_string(count) + " " + std::string(list) + " are not used");
    }
  }

  GltfDocument& document_;
  SceneBuilder builder_;
  GltfMeshes meshes_;
  std::vector<bool> visited_;
  std::uint64_t name_bytes_ = 0;
  std::vector<LoadedScene::NamedView> cameras_;
  static constexpr std::size_t no_node = static_cast<std::size_t>(-1);
  std::vector<std::size_t> parents_;       // of every node that was reached
  std::vector<std::size_t> camera_nodes_;  // parallel to cameras_
  std::vector<LoadedScene::MovingView> moving_cameras_;
  bool animations_used_ = false, animations_all_used_ = false;
};

}  // namespace

LoadedScene read_gltf(const std::filesystem::path& file, Bytes bytes) {
  GltfDocument document(file, std::move(bytes));
  return GltfReader(document).read();
}

}  // namespace sightline
