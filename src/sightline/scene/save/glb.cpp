// Scenes into GLB files (glTF 2.0 binary, no extensions).
// Source: glTF 2.0 specification, section 4 (GLB).
#include "sightline/scene/save/glb.hpp"

#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sightline/scene/input_error.hpp"
#include "sightline/scene/save/output_file.hpp"

namespace sightline {

static_assert(std::endian::native == std::endian::little, "GLB numbers are written as they lie in memory");

namespace {

/// Vertices of a mesh whose indices fit 16 bits; 65535 itself is not allowed as an index.
constexpr std::size_t most_short_vertices = 65535;
constexpr int mat4_numbers = 16;

void append(std::string& text, float number) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
  text.append(digits.data(), end);
}

void append(std::string& text, const glm::vec3& v) {
  for (int i = 0; i < 3; ++i) {
    text += i == 0 ? "[" : ",";
    append(text, v[i]);
  }
  text += ']';
}

std::string quote(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// Where the parts of a mesh lie in the file; index bytes are counted from the start of all indices.
struct MeshPlace {
  std::uint64_t number = 0;  // among the meshes written
  std::uint64_t positions = 0, indices = 0;
  bool short_indices = false;
  /// Numbers of the glTF meshes for opaque objects and for the others; -1 where there are none.
  std::int64_t opaque = -1, see_through = -1;
};

class GlbWriter {
 public:
  GlbWriter(const Scene& scene, const std::filesystem::path& path) : scene_(scene), path_(path) { place_meshes(); }

  void write() {
    const std::string json = padded(json_text(), ' ');
    const std::uint64_t binary = (position_bytes_ + index_bytes_ + 3) / 4 * 4;
    const std::uint64_t total = 12 + 8 + json.size() + (binary > 0 ? 8 + binary : 0);
    if (total > 0xFFFFFFFFu) throw InputError(path_.string(), "", "would exceed the 4 GiB of a GLB");
    OutputFile file(path_);
    file.write("glTF" + word(2) + word(total) + word(json.size()) + "JSON");
    file.write(json);
    if (binary > 0) {
      file.write(word(binary) + std::string("BIN\0", 4));
      write_positions(file);
      write_indices(file);
      file.write(std::string(static_cast<std::size_t>(binary - position_bytes_ - index_bytes_), '\0'));
    }
    file.commit();
  }

 private:
  static std::string word(std::uint64_t value) {
    const auto number = static_cast<std::uint32_t>(value);
    std::string bytes(sizeof(number), '\0');
    std::memcpy(bytes.data(), &number, sizeof(number));
    return bytes;
  }

  static std::string padded(std::string text, char filler) {
    text.resize((text.size() + 3) / 4 * 4, filler);
    return text;
  }

  static bool is_empty(const Mesh& mesh) { return mesh.triangles.empty() || mesh.positions.empty(); }

  void place_meshes() {
    places_.resize(scene_.meshes().size());
    for (const Object& object : scene_.objects()) {
      MeshPlace& place = places_[object.mesh];
      if (is_empty(scene_.meshes()[object.mesh])) continue;
      if (place.opaque < 0 && place.see_through < 0) place_mesh(object.mesh, place);
      std::int64_t& number = object.opaque ? place.opaque : place.see_through;
      if (number < 0) {
        number = static_cast<std::int64_t>(gltf_meshes_.size());
        gltf_meshes_.push_back({object.mesh, object.opaque});
      }
    }
  }

  void place_mesh(MeshId id, MeshPlace& place) {
    const Mesh& mesh = scene_.meshes()[id];
    place.number = written_.size();
    place.positions = position_bytes_;
    place.indices = index_bytes_;
    place.short_indices = mesh.positions.size() <= most_short_vertices;
    position_bytes_ += mesh.positions.size() * sizeof(glm::vec3);
    index_bytes_ += (mesh.triangles.size() * 3 * (place.short_indices ? 2 : 4) + 3) / 4 * 4;
    written_.push_back(id);
  }

  void write_positions(OutputFile& file) const {
    for (const MeshId id : written_) {
      const std::vector<glm::vec3>& positions = scene_.meshes()[id].positions;
      file.write({reinterpret_cast<const char*>(positions.data()), positions.size() * sizeof(glm::vec3)});
    }
  }

  void write_indices(OutputFile& file) const {
    std::vector<std::uint16_t> short_indices;
    for (const MeshId id : written_) {
      const std::vector<glm::uvec3>& triangles = scene_.meshes()[id].triangles;
      if (!places_[id].short_indices) {
        file.write({reinterpret_cast<const char*>(triangles.data()), triangles.size() * sizeof(glm::uvec3)});
        continue;
      }
      short_indices.clear();
      for (const glm::uvec3& triangle : triangles) {
        for (int corner = 0; corner < 3; ++corner)
          short_indices.push_back(static_cast<std::uint16_t>(triangle[corner]));
      }
      if (short_indices.size() % 2 != 0) short_indices.push_back(0);
      file.write({reinterpret_cast<const char*>(short_indices.data()), short_indices.size() * sizeof(std::uint16_t)});
    }
  }

  [[nodiscard]] std::string json_text() const {
    std::string text = R"({"asset":{"version":"2.0","generator":"sightline"},"scene":0,"scenes":[{)";
    const std::size_t nodes = scene_.objects().size();
    for (std::size_t i = 0; i < nodes; ++i) text += (i == 0 ? "\"nodes\":[" : ",") + std::to_string(i);
    text += nodes == 0 ? "}]" : "]}]";
    append_list(text, "nodes", nodes, [&](std::size_t i) { append_node(text, static_cast<ObjectId>(i)); });
    append_list(text, "meshes", gltf_meshes_.size(), [&](std::size_t i) { append_mesh(text, gltf_meshes_[i]); });
    append_list(text, "accessors", written_.size(), [&](std::size_t i) { append_accessors(text, written_[i]); });
    if (!written_.empty()) {
      text += R"(,"bufferViews":[{"buffer":0,"byteLength":)" + std::to_string(position_bytes_) +
              R"(,"byteStride":12,"target":34962},{"buffer":0,"byteOffset":)" + std::to_string(position_bytes_) +
              R"(,"byteLength":)" + std::to_string(index_bytes_) + R"(,"target":34963}],"buffers":[{"byteLength":)" +
              std::to_string(position_bytes_ + index_bytes_) + "}]";
    }
    for (const GltfMesh& mesh : gltf_meshes_) {
      if (mesh.opaque) continue;
      text += R"(,"materials":[{"name":"see-through","alphaMode":"BLEND"}])";
      break;
    }
    return text + "}";
  }

  template <class Entry>
  static void append_list(std::string& text, std::string_view name, std::size_t count, Entry append_entry) {
    if (count == 0) return;
    text.append(",\"").append(name).append("\":[");
    for (std::size_t i = 0; i < count; ++i) {
      if (i > 0) text += ',';
      append_entry(i);
    }
    text += ']';
  }

  void append_node(std::string& text, ObjectId id) const {
    const Object& object = scene_.objects()[id];
    const std::int64_t mesh = object.opaque ? places_[object.mesh].opaque : places_[object.mesh].see_through;
    text += "{\"name\":" + quote(scene_.name(id));
    if (mesh >= 0) text += ",\"mesh\":" + std::to_string(mesh);
    if (object.transform != identity_affine()) {
      for (int i = 0; i < mat4_numbers; ++i) {
        text += i == 0 ? ",\"matrix\":[" : ",";
        append(text, i % 4 < 3 ? object.transform[i / 4][i % 4] : (i == mat4_numbers - 1 ? 1.0f : 0.0f));
      }
      text += ']';
    }
    text += '}';
  }

  struct GltfMesh {
    MeshId mesh;
    bool opaque;
  };

  /// Mesh k of those written has accessors 2 k (positions) and 2 k + 1 (indices).
  void append_mesh(std::string& text, const GltfMesh& mesh) const {
    const std::uint64_t k = places_[mesh.mesh].number;
    text += "{\"name\":" + quote(scene_.meshes()[mesh.mesh].name) + R"(,"primitives":[{"attributes":{"POSITION":)" +
            std::to_string(2 * k) + R"(},"indices":)" + std::to_string(2 * k + 1) +
            (mesh.opaque ? "}]}" : ",\"material\":0}]}");
  }

  void append_accessors(std::string& text, MeshId id) const {
    const Mesh& mesh = scene_.meshes()[id];
    const MeshPlace& place = places_[id];
    text += R"({"bufferView":0,"byteOffset":)" + std::to_string(place.positions) +
            R"(,"componentType":5126,"type":"VEC3","count":)" + std::to_string(mesh.positions.size()) + ",\"min\":";
    append(text, mesh.bounds.lo);
    text += ",\"max\":";
    append(text, mesh.bounds.hi);
    text += R"(},{"bufferView":1,"byteOffset":)" + std::to_string(place.indices) +
            (place.short_indices ? R"(,"componentType":5123)" : R"(,"componentType":5125)") +
            R"(,"type":"SCALAR","count":)" + std::to_string(mesh.triangles.size() * 3) + "}";
  }

  const Scene& scene_;
  const std::filesystem::path& path_;
  std::vector<MeshPlace> places_;
  std::vector<MeshId> written_;
  std::vector<GltfMesh> gltf_meshes_;
  std::uint64_t position_bytes_ = 0, index_bytes_ = 0;
};

}  // namespace

void save_glb(const Scene& scene, const std::filesystem::path& path) { GlbWriter(scene, path).write(); }

}  // namespace sightline
