// A number that changes with any bit of a scene: FNV-1a over everything that it holds.
#pragma once

#include <cstdint>
#include <cstring>
#include <string_view>

#include "sightline/scene/scene.hpp"

namespace sightline {

class Hash {
 public:
  void add(std::uint64_t value) {
    for (int i = 0; i < 8; ++i) {
      value_ = (value_ ^ ((value >> (8 * i)) & 255)) * 0x100000001B3u;
    }
  }
  void add(float value) { add(static_cast<std::uint64_t>(bits(value))); }
  void add(const glm::vec3& v) {
    for (int i = 0; i < 3; ++i) add(v[i]);
  }
  void add(std::string_view text) {
    add(std::uint64_t{text.size()});
    for (const char c : text) add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  static std::uint32_t bits(float value) {
    std::uint32_t result = 0;
    static_assert(sizeof result == sizeof value);
    std::memcpy(&result, &value, sizeof value);
    return result;
  }
  std::uint64_t value_ = 0xCBF29CE484222325u;
};

inline std::uint64_t hash_of(const Scene& scene) {
  Hash hash;
  for (const Mesh& mesh : scene.meshes()) {
    hash.add(mesh.name);
    hash.add(std::uint64_t{mesh.closed});
    for (const glm::vec3& p : mesh.positions) hash.add(p);
    for (const glm::uvec3& t : mesh.triangles)
      for (int i = 0; i < 3; ++i) hash.add(std::uint64_t{t[i]});
  }
  for (ObjectId id = 0; id < scene.objects().size(); ++id) {
    const Object& object = scene.objects()[id];
    hash.add(scene.name(id));
    hash.add(std::uint64_t{object.mesh} * 2 + (object.opaque ? 1 : 0));
    for (int c = 0; c < 4; ++c) hash.add(object.transform[c]);
    hash.add(object.bounds.lo);
    hash.add(object.bounds.hi);
  }
  for (const Cell& cell : scene.cells()) {
    hash.add(cell.name);
    hash.add(cell.bounds.lo);
    hash.add(cell.bounds.hi);
    for (const ObjectId id : cell.objects) hash.add(std::uint64_t{id});
  }
  for (const Portal& portal : scene.portals()) {
    hash.add(std::uint64_t{portal.cells[0]} << 32 | portal.cells[1]);
    for (const glm::vec3& p : portal.polygon) hash.add(p);
  }
  return hash.value();
}

}  // namespace sightline
