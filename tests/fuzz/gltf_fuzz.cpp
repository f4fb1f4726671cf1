// Any bytes as a glTF file; buffers beside the file do not exist.
// Input that begins with '{' is JSON up to the first byte 0 and a binary chunk after it, made into a GLB with right
// lengths, so that changes reach what lies behind the container. Other input is the file itself.
#include <cstring>
#include <span>

#include "reader.hpp"

namespace {

using sightline::Bytes;

void append_word(Bytes& bytes, std::size_t value) {
  const auto number = static_cast<std::uint32_t>(value);
  const auto* begin = reinterpret_cast<const std::byte*>(&number);
  bytes.insert(bytes.end(), begin, begin + sizeof(number));
}

void append_chunk(Bytes& bytes, const char* type, std::span<const std::byte> content, char filler) {
  const std::size_t padded = (content.size() + 3) / 4 * 4;
  append_word(bytes, padded);
  const auto* name = reinterpret_cast<const std::byte*>(type);
  bytes.insert(bytes.end(), name, name + 4);
  bytes.insert(bytes.end(), content.begin(), content.end());
  bytes.resize(bytes.size() + padded - content.size(), static_cast<std::byte>(filler));
}

Bytes glb_of(std::span<const std::byte> data) {
  std::size_t end = 0;
  while (end < data.size() && data[end] != std::byte{0}) ++end;
  Bytes chunks;
  append_chunk(chunks, "JSON", data.first(end), ' ');
  if (end < data.size()) append_chunk(chunks, "BIN\0", data.subspan(end + 1), '\0');
  Bytes glb(4);
  std::memcpy(glb.data(), "glTF", 4);
  append_word(glb, 2);
  append_word(glb, 12 + chunks.size());
  glb.insert(glb.end(), chunks.begin(), chunks.end());
  return glb;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace sightline;
  Bytes bytes = fuzz::bytes_of(data, size);
  if (size > 0 && data[0] == '{') bytes = glb_of(bytes);
  return fuzz::expect_one_line(
      [&] { fuzz::expect_sound(read_gltf("/nonexistent/fuzz.gltf", std::move(bytes)).scene); });
}
