// A glTF 2.0 file opened: its JSON, and the bytes of its buffers and buffer views, checked and fetched when first asked
// for. Promise: no view reaches outside its buffer; nothing much larger than the file is ever allocated (see spend).
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "sightline/scene/load/file_bytes.hpp"
#include "sightline/scene/load/gltf_container.hpp"
#include "sightline/scene/load/json_object.hpp"

namespace sightline {

class GltfDocument {
 public:
  /// `file` names the bytes in messages, and its folder is where external buffers lie.
  /// Throws InputError: no glTF 2.x, broken JSON or GLB, a required extension that we do not have.
  GltfDocument(const std::filesystem::path& file, Bytes bytes);
  GltfDocument(const GltfDocument&) = delete;
  GltfDocument& operator=(const GltfDocument&) = delete;

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] JsonObject root() const { return {json_, file_, ""}; }
  [[nodiscard]] std::size_t count(std::string_view list) const { return root().count(list); }
  [[nodiscard]] JsonObject item(std::string_view list, std::size_t index) const { return root().item(list, index); }

  /// The bytes of bufferViews[index], decompressed if need be. Throws InputError.
  std::span<const std::byte> view(std::size_t index);

  /// Notes that `bytes` are about to be allocated for `what`. Throws InputError if that makes the whole much larger
  /// than the file can be meant to hold, so that a small file cannot ask for all memory.
  void spend(std::uint64_t bytes, const JsonObject& what);

  /// Notes that something is not used. Of the same kind of thing only the first place and their number are kept.
  void warn(const std::string& what, const std::string& where = {});
  /// One line for each kind of thing.
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct Warning {
    std::string where;
    std::size_t count;
  };

  void check_version() const;
  void check_extensions();
  std::span<const std::byte> buffer(std::size_t index);
  Bytes read_buffer(const JsonObject& buffer, std::uint64_t length) const;
  std::span<const std::byte> range(const JsonObject& view);

  std::string file_;
  Bytes bytes_;
  GltfChunks chunks_;
  nlohmann::json json_;
  std::map<std::size_t, Bytes> buffers_;  // external ones and data URIs, by number
  std::map<std::size_t, Bytes> decoded_;  // compressed buffer views, by number
  std::uint64_t spent_ = 0;
  std::uint64_t allowance_;
  std::map<std::string, Warning> warnings_;
};

/// The extension of that name; nothing if `object` does not have it.
std::optional<JsonObject> gltf_extension(const JsonObject& object, std::string_view name);

}  // namespace sightline
