// Meshes of a glTF file: every primitive becomes a Mesh once, however many nodes use it.
#include "sightline/scene/load/gltf_mesh.hpp"

#include <algorithm>
#include <numeric>
#include <string>

#include "sightline/scene/load/gltf_accessor.hpp"
#include "sightline/scene/load/gltf_draco.hpp"

namespace sightline {

static_assert(sizeof(glm::uvec3) == 3 * sizeof(std::uint32_t));

namespace {

constexpr std::uint64_t mode_triangles = 4, mode_fan = 6;  // and strips between
constexpr std::uint64_t mode_draco = 7;                    // none of glTF's, marks the key of compressed primitives
constexpr std::uint64_t most_draco_id = 0xFFFFFFFFu;
constexpr std::size_t no_accessor = static_cast<std::size_t>(-1);

std::string mesh_name(const JsonObject& mesh, std::size_t index) {
  const std::string& name = mesh.text("name");
  return name.empty() ? "mesh " + std::to_string(index) : name;
}

/// Vertex numbers of consecutive corners as triangles; corners that complete no triangle are left out.
std::vector<glm::uvec3> assemble(std::span<const std::uint32_t> corners, std::uint64_t mode) {
  std::vector<glm::uvec3> triangles;
  if (corners.size() < 3) return triangles;
  if (mode == mode_triangles) {
    triangles.resize(corners.size() / 3);
    std::copy_n(corners.data(), triangles.size() * 3, &triangles[0][0]);
    return triangles;
  }
  triangles.reserve(corners.size() - 2);
  for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
    if (mode == mode_fan) {
      triangles.emplace_back(corners[0], corners[i + 1], corners[i + 2]);
    } else {
      // Every other triangle of a strip runs the other way round.
      triangles.emplace_back(corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]);
    }
  }
  return triangles;
}

}  // namespace

GltfMeshes::GltfMeshes(GltfDocument& document, SceneBuilder& builder)
    : document_(document), builder_(builder), parts_(document.count("meshes")), uses_(document.count("accessors")) {
  count_uses();
}

void GltfMeshes::count_uses() {
  for (std::size_t m = 0; m < parts_.size(); ++m) {
    const JsonObject mesh = document_.item("meshes", m);
    for (std::size_t p = 0; p < mesh.count("primitives"); ++p) {
      const std::optional<JsonObject> attributes = mesh.item("primitives", p).object("attributes");
      if (!attributes) continue;
      if (const auto position = attributes->reference("POSITION", uses_.size())) ++uses_[*position];
    }
  }
}

std::span<const GltfMeshes::Part> GltfMeshes::parts(std::size_t index) {
  std::optional<std::vector<Part>>& parts = parts_[index];
  if (!parts) parts = read_parts(index);
  return *parts;
}

std::vector<GltfMeshes::Part> GltfMeshes::read_parts(std::size_t index) {
  const JsonObject mesh = document_.item("meshes", index);
  const std::string name = mesh_name(mesh, index);
  const std::size_t count = mesh.count("primitives");
  if (count == 0) mesh.fail("primitives", "is missing or empty");
  std::vector<Part> parts;
  for (std::size_t p = 0; p < count; ++p) {
    const JsonObject primitive = mesh.item("primitives", p);
    const bool opaque = is_opaque(primitive);
    if (const auto id = read_geometry(primitive, name)) parts.push_back({*id, static_cast<std::int32_t>(p), opaque});
    if (primitive.count("targets") > 0) document_.warn("morph targets are not used", primitive.place());
  }
  return parts;
}

std::optional<MeshId> GltfMeshes::read_geometry(const JsonObject& primitive, const std::string& name) {
  const std::uint64_t mode = primitive.integer("mode", mode_fan).value_or(mode_triangles);
  const std::optional<JsonObject> attributes = primitive.object("attributes");
  const auto position = attributes ? attributes->reference("POSITION", uses_.size()) : std::nullopt;
  if (mode < mode_triangles || !position) {
    document_.warn(position ? "points and lines are left out" : "has no positions, left out", primitive.place());
    return std::nullopt;
  }
  const std::optional<JsonObject> draco = gltf_extension(primitive, "KHR_draco_mesh_compression");
  const Key key = draco ? draco_key(*draco)
                        : Key{mode, *position, primitive.reference("indices", uses_.size()).value_or(no_accessor)};
  if (const auto known = geometry_.find(key); known != geometry_.end()) return known->second;

  Mesh mesh = draco                   ? read_draco(*draco, key)
              : uses_[*position] == 1 ? read_alone(primitive, *position, mode)
                                      : read_shared(primitive, *position, mode);
  std::optional<MeshId> id;
  if (mesh.triangles.empty()) {
    document_.warn("has no triangles, left out", primitive.place());
  } else {
    mesh.name = name;
    id = builder_.add_mesh(std::move(mesh));
  }
  geometry_.emplace(key, id);
  return id;
}

GltfMeshes::Key GltfMeshes::draco_key(const JsonObject& draco) const {
  const auto view = draco.reference("bufferView", document_.count("bufferViews"));
  if (!view) draco.fail("bufferView", "is missing");
  const std::optional<JsonObject> attributes = draco.object("attributes");
  if (!attributes) draco.fail("attributes", "is missing");
  return {mode_draco, *view, static_cast<std::size_t>(attributes->required_integer("POSITION", most_draco_id))};
}

Mesh GltfMeshes::read_draco(const JsonObject& draco, const Key& key) {
  const auto& [mode, view, position] = key;
  Mesh mesh = decode_draco(draco, document_.view(view), static_cast<std::uint32_t>(position));
  document_.spend((mesh.positions.size() + mesh.triangles.size()) * sizeof(glm::vec3), draco);
  return mesh;
}

Mesh GltfMeshes::read_alone(const JsonObject& primitive, std::size_t position, std::uint64_t mode) {
  Mesh mesh;
  mesh.positions = read_points(document_, position);
  mesh.triangles = read_triangles(primitive, mesh.positions.size(), mode);
  return mesh;
}

Mesh GltfMeshes::read_shared(const JsonObject& primitive, std::size_t position, std::uint64_t mode) {
  auto pool = shared_.find(position);
  if (pool == shared_.end()) {
    pool = shared_.emplace(position, VertexPool(read_points(document_, position))).first;
    document_.spend(pool->second.size() * sizeof(std::uint64_t), primitive);
  }
  std::vector<glm::uvec3> triangles = read_triangles(primitive, pool->second.size(), mode);
  document_.spend(std::uint64_t{triangles.size()} * 3 * sizeof(glm::vec3), primitive);
  return pool->second.mesh_of(std::move(triangles));
}

std::vector<glm::uvec3> GltfMeshes::read_triangles(const JsonObject& primitive, std::size_t points,
                                                   std::uint64_t mode) {
  std::vector<std::uint32_t> corners;
  if (const auto indices = primitive.reference("indices", uses_.size())) {
    corners = read_indices(document_, *indices);
  } else {
    document_.spend(points * sizeof(std::uint32_t), primitive);
    corners.resize(points);
    std::iota(corners.begin(), corners.end(), 0u);
  }
  std::uint32_t largest = 0;
  for (const std::uint32_t corner : corners) largest = std::max(largest, corner);
  if (!corners.empty() && largest >= points) {
    primitive.fail("indices",
                   "vertex " + std::to_string(largest) + " is beyond the " + std::to_string(points) + " there are");
  }
  if (mode == mode_triangles && corners.size() % 3 != 0) {
    document_.warn("the last corners make no triangle", primitive.place());
  }
  document_.spend(std::uint64_t{corners.size()} * sizeof(glm::uvec3), primitive);
  return assemble(corners, mode);
}

bool GltfMeshes::is_opaque(const JsonObject& primitive) const {
  const auto index = primitive.reference("material", document_.count("materials"));
  if (!index) return true;
  const JsonObject material = document_.item("materials", *index);
  const std::string& mode = material.text("alphaMode");
  if (!mode.empty() && mode != "OPAQUE" && mode != "MASK" && mode != "BLEND") {
    material.fail("alphaMode", in_quotes(mode) + " is none of OPAQUE, MASK, BLEND");
  }
  const std::optional<JsonObject> transmission = gltf_extension(material, "KHR_materials_transmission");
  const bool transmits = transmission && transmission->number("transmissionFactor").value_or(0.0) > 0.0;
  return !transmits && mode != "MASK" && mode != "BLEND";
}

}  // namespace sightline
