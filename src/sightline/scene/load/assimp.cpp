// PLY, STL, DAE, FBX, 3DS and IFC into a scene by the Open Asset Import Library; an object is a mesh of a node.
// Promise: nothing that the file has and we drop goes unsaid; lengths are metres and Y is up where the format tells
// units and axes; whatever the library does with a broken file, crash included, becomes one InputError: it runs in a
// process of its own, which hands over plain data.
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cstdlib>
#include <cstring>
#include <new>
#include <optional>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/child_process.hpp"
#include "sightline/scene/load/readers.hpp"

namespace sightline {

namespace {

constexpr unsigned int steps = aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_RemoveComponent |
                               aiProcess_JoinIdenticalVertices | aiProcess_GlobalScale;
/// Removed first, so that vertices with the same position are the same vertex.
constexpr int surface_data =
    aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS | aiComponent_TEXCOORDS;

glm::dmat4 matrix_of(const aiNode& node) {
  const aiMatrix4x4& m = node.mTransformation;
  return {m.a1, m.b1, m.c1, 0.0, m.a2, m.b2, m.c2, 0.0, m.a3, m.b3, m.c3, 0.0, m.a4, m.b4, m.c4, 1.0};
}

/// What turns an FBX file's axes into right, up and front: assimp hands them on as metadata and leaves them as they
/// are. For other formats, which it turns itself, the identity.
glm::dmat4 axes_of(const aiScene& scene) {
  constexpr std::array<std::pair<const char*, const char*>, 3> keys = {
      {{"CoordAxis", "CoordAxisSign"}, {"UpAxis", "UpAxisSign"}, {"FrontAxis", "FrontAxisSign"}}};
  glm::dmat4 turn(0.0);
  turn[3][3] = 1.0;
  for (int to = 0; to < 3; ++to) {
    std::int32_t from = 0, sign = 0;
    const auto& [axis_key, sign_key] = keys[static_cast<std::size_t>(to)];
    const bool known = scene.mMetaData != nullptr && scene.mMetaData->Get(axis_key, from) &&
                       scene.mMetaData->Get(sign_key, sign) && from >= 0 && from < 3 && std::abs(sign) == 1;
    if (!known) return glm::dmat4(1.0);
    turn[from][to] = sign;
  }
  return std::abs(glm::determinant(turn)) == 1.0 ? turn : glm::dmat4(1.0);
}

bool is_opaque(const aiScene& scene, const aiMesh& mesh) {
  if (mesh.mMaterialIndex >= scene.mNumMaterials) return true;
  const aiMaterial& material = *scene.mMaterials[mesh.mMaterialIndex];
  float opacity = 1.0f, transmission = 0.0f;
  material.Get(AI_MATKEY_OPACITY, opacity);
  material.Get(AI_MATKEY_TRANSMISSION_FACTOR, transmission);
  return opacity >= 1.0f && transmission <= 0.0f && material.GetTextureCount(aiTextureType_OPACITY) == 0;
}

Mesh convert(const aiMesh& source, std::size_t index) {
  Mesh mesh;
  mesh.name = source.mName.length > 0 ? one_line(source.mName.C_Str()) : "mesh " + std::to_string(index);
  mesh.positions.reserve(source.mNumVertices);
  for (unsigned int i = 0; i < source.mNumVertices; ++i) {
    mesh.positions.emplace_back(source.mVertices[i].x, source.mVertices[i].y, source.mVertices[i].z);
  }
  mesh.triangles.reserve(source.mNumFaces);
  for (unsigned int i = 0; i < source.mNumFaces; ++i) {
    const aiFace& face = source.mFaces[i];
    if (face.mNumIndices == 3) mesh.triangles.emplace_back(face.mIndices[0], face.mIndices[1], face.mIndices[2]);
  }
  return mesh;
}

/// The plain data that go from the child to its parent: numbers as they lie in memory, arrays after their lengths.
class Writer {
 public:
  explicit Writer(ByteSink& sink) : sink_(sink) {}

  template <class T>
  void value(const T& number) {
    static_assert(std::is_trivially_copyable_v<T>);
    sink_.write(&number, sizeof number);
  }
  template <class T>
  void array(const T* first, std::size_t count) {
    value(std::uint64_t{count});
    if (count > 0) sink_.write(first, count * sizeof(T));
  }
  void text(const std::string& text) { array(text.data(), text.size()); }

 private:
  ByteSink& sink_;
};

/// Throws InputError where the data end early: the child may have broken its own memory.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T>
  T value() {
    T number{};
    std::memcpy(&number, take(sizeof number), sizeof number);
    return number;
  }
  template <class T>
  std::vector<T> array() {
    const auto count = value<std::uint64_t>();
    if (count > bytes_.size() / sizeof(T)) throw InputError(damaged);
    std::vector<T> elements(static_cast<std::size_t>(count));
    if (count > 0) std::memcpy(elements.data(), take(elements.size() * sizeof(T)), elements.size() * sizeof(T));
    return elements;
  }
  std::string text() {
    const std::vector<char> letters = array<char>();
    return {letters.begin(), letters.end()};
  }

 private:
  static constexpr const char* damaged = "is broken in a way that its reader does not survive";
  const std::byte* take(std::size_t count) {
    if (count > bytes_.size()) throw InputError(damaged);
    const std::byte* begin = bytes_.data();
    bytes_ = bytes_.subspan(count);
    return begin;
  }
  std::span<const std::byte> bytes_;
};

enum : std::uint8_t { record_end, record_mesh, record_object, record_warning };

/// Runs in the child.
class AssimpReader {
 public:
  AssimpReader(const aiScene& scene, ByteSink& sink) : scene_(scene), writer_(sink), ids_(scene.mNumMeshes) {}

  void read() {
    walk();
    for (const std::string& warning : warnings()) {
      writer_.value(record_warning);
      writer_.text(warning);
    }
    writer_.value(record_end);
  }

 private:
  struct Visit {
    const aiNode* node;
    glm::dmat4 parent;
  };

  /// Depth first, children in their order, without recursion.
  void walk() {
    std::vector<Visit> pending = {{scene_.mRootNode, axes_of(scene_)}};
    for (std::int32_t number = 0; !pending.empty(); ++number) {
      const Visit visit = pending.back();
      pending.pop_back();
      const glm::dmat4 world = visit.parent * matrix_of(*visit.node);
      for (unsigned int i = 0; i < visit.node->mNumMeshes; ++i) add_object(*visit.node, i, number, world);
      for (unsigned int i = visit.node->mNumChildren; i-- > 0;) pending.push_back({visit.node->mChildren[i], world});
    }
  }

  void add_object(const aiNode& node, unsigned int part, std::int32_t number, const glm::dmat4& world) {
    const unsigned int index = node.mMeshes[part];
    const aiMesh& mesh = *scene_.mMeshes[index];
    if ((mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) {
      ++left_out_;
      return;
    }
    if (!ids_[index]) {
      ids_[index] = meshes_++;
      const Mesh converted = convert(mesh, index);
      writer_.value(record_mesh);
      writer_.text(converted.name);
      writer_.array(converted.positions.data(), converted.positions.size());
      writer_.array(converted.triangles.data(), converted.triangles.size());
    }
    std::string name = one_line(node.mName.C_Str());
    if (name.empty()) name = one_line(mesh.mName.C_Str());
    if (name.empty()) name = "node " + std::to_string(number);
    writer_.value(record_object);
    writer_.value(*ids_[index]);
    writer_.value(to_affine(world));
    writer_.text(name);
    writer_.value(Source{number, static_cast<std::int32_t>(part)});
    writer_.value(std::uint8_t{is_opaque(scene_, mesh)});
  }

  [[nodiscard]] std::vector<std::string> warnings() const {
    std::vector<std::string> lines;
    const auto dropped = [&](std::size_t count, const char* what) {
      if (count > 0) lines.push_back(std::to_string(count) + " " + what);
    };
    std::size_t skinned = 0, morphed = 0;
    for (unsigned int i = 0; i < scene_.mNumMeshes; ++i) {
      skinned += scene_.mMeshes[i]->mNumBones > 0 ? 1 : 0;
      morphed += scene_.mMeshes[i]->mNumAnimMeshes > 0 ? 1 : 0;
    }
    dropped(left_out_, "meshes of points or lines are left out");
    dropped(scene_.mNumAnimations, "animations are not used");
    dropped(skinned, "meshes with bones are shown as modelled");
    dropped(morphed, "meshes with morph targets are shown as modelled");
    dropped(scene_.mNumLights, "lights are not used");
    dropped(scene_.mNumCameras, "cameras are not used");
    dropped(scene_.mNumTextures, "embedded textures are not used");
    return lines;
  }

  const aiScene& scene_;
  Writer writer_;
  std::vector<std::optional<MeshId>> ids_;
  MeshId meshes_ = 0;
  std::size_t left_out_ = 0;
};

/// Before any step that follows the indices: assimp takes those of a PLY as they come.
void check_indices(const aiScene& scene) {
  for (unsigned int m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned int f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      for (unsigned int i = 0; i < face.mNumIndices; ++i)
        if (face.mIndices[i] >= mesh.mNumVertices)
          throw std::runtime_error("mesh " + std::to_string(m) + ": face " + std::to_string(f) + ": vertex " +
                                   std::to_string(face.mIndices[i]) + " is beyond the " +
                                   std::to_string(mesh.mNumVertices) + " there are");
    }
  }
}

void import(const std::filesystem::path& file, ByteSink& sink) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, surface_data);
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (scene != nullptr) {
    check_indices(*scene);
    scene = importer.ApplyPostProcessing(steps);
  }
  if (scene == nullptr) {
    const std::string error = one_line(importer.GetErrorString());
    if (error == std::bad_alloc().what()) throw std::bad_alloc();
    throw std::runtime_error(error.empty() ? "has no meshes" : error);
  }
  if (scene->mRootNode == nullptr || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0) {
    throw std::runtime_error("has no meshes");
  }
  AssimpReader(*scene, sink).read();
}

std::string_view text_of(const Bytes& bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

/// Takes the next line that is not empty off the front of `rest`; empty if there is none.
std::string_view next_line(std::string_view& rest) {
  rest.remove_prefix(std::min(rest.find_first_not_of("\r\n"), rest.size()));
  const std::string_view line = rest.substr(0, rest.find_first_of("\r\n"));
  rest.remove_prefix(line.size());
  return line;
}

/// Assimp looks for the end of a PLY header for ever, and makes up what a text has no lines for.
void check_ply(const std::filesystem::path& file) {
  constexpr std::uint64_t longest_header = 1 << 20;
  constexpr std::string_view end = "end_header";
  const Bytes start = read_file(file, longest_header);
  std::string_view header = text_of(start);
  if (!header.starts_with("ply")) return;
  const std::size_t length = header.find(end);
  if (length == std::string_view::npos) throw InputError(file.string(), "", "the header of the PLY has no end");
  header = header.substr(0, length);
  if (header.find("\nformat ascii") == std::string_view::npos) return;
  const Bytes whole = read_file(file);
  std::string_view body = text_of(whole).substr(length + end.size());
  while (!header.empty()) {
    std::istringstream words{std::string(next_line(header))};
    std::string keyword, name;
    std::uint64_t count = 0;
    if (!(words >> keyword >> name >> count) || keyword != "element") continue;
    for (std::uint64_t i = 0; i < count; ++i)
      if (next_line(body).empty())
        throw InputError(file.string(), "",
                         "element " + name + ": has " + std::to_string(i) + " lines, not " + std::to_string(count));
  }
}

/// True for a text that ends before its solid does; assimp keeps the facets so far.
bool is_cut_off_stl(const std::filesystem::path& file) {
  constexpr std::string_view begin = "solid";
  constexpr std::size_t binary_header = 84, facet = 50;
  if (text_of(read_file(file, begin.size())) != begin) return false;
  const Bytes bytes = read_file(file);
  const bool binary = bytes.size() >= binary_header && (bytes.size() - binary_header) % facet == 0;
  return !binary && text_of(bytes).rfind("endsolid") == std::string_view::npos;
}

LoadedScene assemble(Reader reader) {
  SceneBuilder builder;
  LoadedScene loaded;
  for (auto record = reader.value<std::uint8_t>(); record != record_end; record = reader.value<std::uint8_t>()) {
    if (record == record_mesh) {
      Mesh mesh;
      mesh.name = reader.text();
      mesh.positions = reader.array<glm::vec3>();
      mesh.triangles = reader.array<glm::uvec3>();
      builder.add_mesh(std::move(mesh));
    } else if (record == record_object) {
      const auto mesh = reader.value<MeshId>();
      const auto transform = reader.value<Affine>();
      const std::string name = reader.text();
      const auto source = reader.value<Source>();
      builder.add_object(mesh, transform, name, source, reader.value<std::uint8_t>() != 0);
    } else {
      loaded.warnings.push_back(reader.text());
    }
  }
  loaded.scene = builder.build();
  return loaded;
}

}  // namespace

LoadedScene read_with_assimp(const std::filesystem::path& file) {
  if (read_file(file, 1).empty()) throw InputError(file.string(), "", "is empty");
  check_ply(file);
  const Bytes bytes = run_in_child(file, [&](ByteSink& sink) { import(file, sink); });
  try {
    LoadedScene loaded = assemble(Reader(bytes));
    if (is_cut_off_stl(file)) loaded.warnings.emplace_back("has no endsolid: the file may be cut off");
    return loaded;
  } catch (const InputError& error) {
    throw InputError(file.string(), error.position(), error.reason());
  }
}

}  // namespace sightline
