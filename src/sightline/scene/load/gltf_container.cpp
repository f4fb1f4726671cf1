// The outer layers of a glTF 2.0 file: GLB chunks, base64 data URIs, and URIs of files beside the scene.
#include "sightline/scene/load/gltf_container.hpp"

#include <array>
#include <bit>
#include <cstring>

#include "sightline/scene/input_error.hpp"

namespace sightline {

static_assert(std::endian::native == std::endian::little, "glTF numbers are read as they lie in the file");

namespace {

constexpr std::uint32_t glb_magic = 0x46546C67u;     // "glTF"
constexpr std::uint32_t json_chunk = 0x4E4F534Au;    // "JSON"
constexpr std::uint32_t binary_chunk = 0x004E4942u;  // "BIN\0"
constexpr std::size_t header_size = 12;
constexpr std::size_t chunk_header_size = 8;

std::uint32_t word_at(std::span<const std::byte> bytes, std::size_t offset) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + offset, sizeof(word));
  return word;
}

GltfChunks split_chunks(const std::string& file, std::span<const std::byte> bytes) {
  GltfChunks chunks;
  bool first = true;
  std::size_t offset = header_size;
  while (bytes.size() - offset >= chunk_header_size) {
    const std::string place = "byte " + std::to_string(offset);
    const std::size_t length = word_at(bytes, offset);
    const std::uint32_t type = word_at(bytes, offset + 4);
    offset += chunk_header_size;
    if (length > bytes.size() - offset) {
      throw InputError(file, place, "chunk of " + std::to_string(length) + " bytes runs past the end of the file");
    }
    if (first && type != json_chunk) throw InputError(file, place, "the first chunk of a GLB must be JSON");
    if (first) {
      chunks.json = bytes.subspan(offset, length);
    } else if (type == binary_chunk && !chunks.binary) {
      chunks.binary = bytes.subspan(offset, length);
    }
    first = false;
    offset += length;
  }
  if (first) throw InputError(file, "byte 12", "the GLB has no JSON chunk");
  return chunks;
}

/// 0 to 63, or -1 for a character that is none of base64's.
constexpr std::array<std::int8_t, 256> base64_values = [] {
  std::array<std::int8_t, 256> values{};
  values.fill(-1);
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < alphabet.size(); ++i) {
    values[static_cast<unsigned char>(alphabet[i])] = static_cast<std::int8_t>(i);
  }
  return values;
}();

std::optional<Bytes> decode_base64(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  Bytes bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    const std::int8_t value = base64_values[static_cast<unsigned char>(c)];
    if (value < 0) return std::nullopt;
    bits = (bits << 6) | static_cast<std::uint32_t>(value);
    bit_count += 6;
    if (bit_count >= 8) {
      bit_count -= 8;
      bytes.push_back(static_cast<std::byte>(bits >> bit_count));
    }
  }
  return bytes;
}

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string decode_percent(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool escape = uri[i] == '%' && i + 2 < uri.size() && hex_value(uri[i + 1]) >= 0 && hex_value(uri[i + 2]) >= 0;
    text += escape ? static_cast<char>(hex_value(uri[i + 1]) * 16 + hex_value(uri[i + 2])) : uri[i];
    if (escape) i += 2;
  }
  return text;
}

}  // namespace

GltfChunks split_gltf(const std::string& file, std::span<const std::byte> bytes) {
  if (bytes.empty()) throw InputError(file, "", "is empty");
  if (bytes.size() < 4 || word_at(bytes, 0) != glb_magic) return {bytes, std::nullopt};
  if (bytes.size() < header_size) throw InputError(file, "byte 4", "the GLB header is cut off");
  const std::uint32_t version = word_at(bytes, 4);
  if (version != 2) throw InputError(file, "byte 4", "GLB version " + std::to_string(version) + " is not 2");
  const std::size_t length = word_at(bytes, 8);
  if (length > bytes.size() || length < header_size) {
    throw InputError(
        file, "byte 8",
        "the GLB claims " + std::to_string(length) + " bytes, the file has " + std::to_string(bytes.size()));
  }
  return split_chunks(file, bytes.first(length));
}

std::optional<Bytes> decode_data_uri(std::string_view uri, const std::string& file, const std::string& place) {
  if (!uri.starts_with("data:")) return std::nullopt;
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64")) {
    throw InputError(file, place, "only base64 data URIs can be read");
  }
  std::optional<Bytes> bytes = decode_base64(uri.substr(comma + 1));
  if (!bytes) throw InputError(file, place, "the data URI has a character that is not base64");
  return bytes;
}

std::filesystem::path resolve_uri(std::string_view uri, const std::string& file, const std::string& place) {
  const std::string text = decode_percent(uri);
  const std::string shown = in_quotes(text);
  const std::size_t colon = text.find(':');
  if (colon != std::string::npos && text.find('/') > colon) {
    throw InputError(file, place, shown + " is not a file beside the scene");
  }
  const std::filesystem::path relative = std::filesystem::path(text).lexically_normal();
  const bool outside = relative.empty() || relative.is_absolute() || *relative.begin() == "..";
  if (outside || text.find('\0') != std::string::npos) {
    throw InputError(file, place, shown + " lies outside the folder of the scene");
  }
  return std::filesystem::path(file).parent_path() / relative;
}

}  // namespace sightline
