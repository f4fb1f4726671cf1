// Small glTF files made by code: a binary chunk that grows, the accessors into it, and JSON around both.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/load.hpp"

namespace sightline::test {

/// A folder of the running test's own, empty at first and removed with it.
class ScratchFolder {
 public:
  ScratchFolder() {
    static int number = 0;
    const testing::TestInfo* info = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("sightline-") + info->test_suite_name() + "-" + info->name() + "-" +
                       std::to_string(::getpid()) + "-" + std::to_string(number++);
    for (char& c : name) {
      if (c == '/') c = '_';
    }
    path_ = std::filesystem::temp_directory_path() / name;
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~ScratchFolder() { std::filesystem::remove_all(path_); }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

inline std::string word(std::uint32_t value) {
  std::string text(4, '\0');
  std::memcpy(text.data(), &value, 4);
  return text;
}

struct GlbFixture {
  nlohmann::json json = {{"asset", {{"version", "2.0"}}}};
  std::string binary;

  /// A buffer view over a copy of `values`, at a multiple of 4 bytes.
  template <class Number>
  std::size_t add_view(std::span<Number> values) {
    static_assert(std::is_trivially_copyable_v<Number>);
    binary.resize((binary.size() + 3) / 4 * 4);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", values.size_bytes()}});
    binary.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
    return json["bufferViews"].size() - 1;
  }

  std::size_t add_accessor(std::size_t view, int component, const std::string& type, std::size_t count) {
    json["accessors"].push_back({{"bufferView", view}, {"componentType", component}, {"type", type}, {"count", count}});
    return json["accessors"].size() - 1;
  }

  std::size_t add_points(const std::vector<glm::vec3>& points) {
    return add_accessor(add_view(std::span(points)), 5126, "VEC3", points.size());
  }

  template <class Index>
  std::size_t add_indices(const std::vector<Index>& indices) {
    const int component = sizeof(Index) == 1 ? 5121 : sizeof(Index) == 2 ? 5123 : 5125;
    return add_accessor(add_view(std::span(indices)), component, "SCALAR", indices.size());
  }

  /// A mesh with one primitive; returns its number.
  std::size_t add_mesh(const nlohmann::json& primitive) {
    json["meshes"].push_back({{"primitives", {primitive}}});
    return json["meshes"].size() - 1;
  }

  std::size_t add_node(const nlohmann::json& node) {
    json["nodes"].push_back(node);
    return json["nodes"].size() - 1;
  }

  [[nodiscard]] std::string json_text() const {
    nlohmann::json whole = json;
    if (!binary.empty() && !whole.contains("buffers")) whole["buffers"] = {{{"byteLength", binary.size()}}};
    return whole.dump();
  }

  [[nodiscard]] std::string glb() const { return glb_of(json_text(), binary); }

  static std::string glb_of(std::string text, std::string chunk) {
    text.resize((text.size() + 3) / 4 * 4, ' ');
    chunk.resize((chunk.size() + 3) / 4 * 4);
    std::string body = word(static_cast<std::uint32_t>(text.size())) + "JSON" + text;
    if (!chunk.empty()) body += word(static_cast<std::uint32_t>(chunk.size())) + std::string("BIN\0", 4) + chunk;
    return "glTF" + word(2) + word(static_cast<std::uint32_t>(12 + body.size())) + body;
  }

  /// Two triangles that make the unit square in z = 0, as mesh 0 with 16-bit indices.
  static GlbFixture square() {
    GlbFixture fixture;
    const std::size_t points = fixture.add_points({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    const std::size_t indices = fixture.add_indices<std::uint16_t>({0, 1, 2, 0, 2, 3});
    fixture.add_mesh({{"attributes", {{"POSITION", points}}}, {"indices", indices}});
    return fixture;
  }
};

/// Loads `bytes` as a file of that name in a folder of its own.
inline LoadedScene load_bytes(std::string_view bytes, const std::string& name = "scene.glb") {
  const ScratchFolder folder;
  return load_scene(folder.write(name, bytes));
}

/// The InputError that loading `bytes` gives, as "position: reason"; "no error" if there is none.
inline std::string load_error(std::string_view bytes, const std::string& name = "scene.glb") {
  try {
    load_bytes(bytes, name);
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    EXPECT_NE(error.file().find(name), std::string::npos) << error.what();
    return error.position() + ": " + error.reason();
  }
  return "no error";
}

/// The corner positions of all triangles of the scene's first object, in world space.
inline std::vector<glm::vec3> corners_of(const Scene& scene, ObjectId id = 0) {
  std::vector<glm::vec3> corners;
  for (const glm::uvec3& t : scene.mesh_of(id).triangles) {
    for (int i = 0; i < 3; ++i) {
      corners.push_back(transform_point(scene.objects()[id].transform, scene.mesh_of(id).positions[t[i]]));
    }
  }
  return corners;
}

}  // namespace sightline::test
