// Meshes of a glTF file: every primitive becomes a Mesh once, however many nodes use it.
// Promise: only vertices that triangles use are kept, so primitives that share one large vertex buffer stay small.
// Source: glTF 2.0 specification, sections 3.7.2 (meshes) and 3.9.4 (alpha modes).
#pragma once

#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "sightline/scene/load/gltf_document.hpp"
#include "sightline/scene/load/vertex_pool.hpp"
#include "sightline/scene/scene.hpp"

namespace sightline {

class GltfMeshes {
 public:
  /// Both must outlive this.
  GltfMeshes(GltfDocument& document, SceneBuilder& builder);

  /// One primitive with triangles.
  struct Part {
    MeshId mesh = 0;
    std::int32_t primitive = 0;
    bool opaque = true;
  };

  /// The primitives of meshes[index] that have triangles, read when first asked for. Throws InputError.
  std::span<const Part> parts(std::size_t index);

 private:
  /// Which geometry a primitive shows: two with the same key share a Mesh, whatever their materials.
  /// (mode, position accessor, index accessor), or for Draco (its mark, buffer view, attribute id).
  using Key = std::tuple<std::uint64_t, std::size_t, std::size_t>;
  void count_uses();
  std::vector<Part> read_parts(std::size_t index);
  std::optional<MeshId> read_geometry(const JsonObject& primitive, const std::string& name);
  [[nodiscard]] Key draco_key(const JsonObject& draco) const;
  Mesh read_draco(const JsonObject& draco, const Key& key);
  Mesh read_alone(const JsonObject& primitive, std::size_t position, std::uint64_t mode);
  Mesh read_shared(const JsonObject& primitive, std::size_t position, std::uint64_t mode);
  std::vector<glm::uvec3> read_triangles(const JsonObject& primitive, std::size_t points, std::uint64_t mode);
  [[nodiscard]] bool is_opaque(const JsonObject& primitive) const;

  GltfDocument& document_;
  SceneBuilder& builder_;
  std::vector<std::optional<std::vector<Part>>> parts_;
  std::map<Key, std::optional<MeshId>> geometry_;
  std::vector<std::uint32_t> uses_;           // how many primitives use an accessor as positions
  std::map<std::size_t, VertexPool> shared_;  // positions that several primitives use, by accessor
};

}  // namespace sightline
