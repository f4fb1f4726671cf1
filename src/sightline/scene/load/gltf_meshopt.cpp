// Buffer views compressed by EXT_meshopt_compression, decoded by meshoptimizer.
#include "sightline/scene/load/gltf_meshopt.hpp"

#include <meshoptimizer.h>

namespace sightline {

namespace {

constexpr std::uint64_t most_elements = 0xFFFFFFFFu;
constexpr std::uint64_t largest_vertex = 256;

struct MeshoptView {
  std::size_t count = 0, stride = 0;
  std::string mode, filter;
};

bool is_allowed(const MeshoptView& view) {
  if (view.mode == "ATTRIBUTES") {
    if (view.stride == 0 || view.stride % 4 != 0) return false;
    if (view.filter == "OCTAHEDRAL") return view.stride == 4 || view.stride == 8;
    if (view.filter == "QUATERNION") return view.stride == 8;
    return view.filter == "NONE" || view.filter == "EXPONENTIAL";
  }
  const bool is_triangles = view.mode == "TRIANGLES" && view.count % 3 == 0;
  const bool is_index = view.stride == 2 || view.stride == 4;
  return (is_triangles || view.mode == "INDICES") && is_index && view.filter == "NONE";
}

MeshoptView open(const JsonObject& extension) {
  MeshoptView view;
  view.count = static_cast<std::size_t>(extension.required_integer("count", most_elements));
  view.stride = static_cast<std::size_t>(extension.required_integer("byteStride", largest_vertex));
  view.mode = extension.text("mode");
  view.filter = extension.has("filter") ? extension.text("filter") : "NONE";
  if (!is_allowed(view)) extension.fail("mode, filter, count and byteStride do not go together");
  return view;
}

}  // namespace

std::uint64_t meshopt_size(const JsonObject& extension) {
  const MeshoptView view = open(extension);
  return std::uint64_t{view.count} * view.stride;
}

Bytes decode_meshopt(const JsonObject& extension, std::span<const std::byte> compressed) {
  const MeshoptView view = open(extension);
  Bytes bytes(view.count * view.stride);
  const auto* source = reinterpret_cast<const unsigned char*>(compressed.data());
  int error = 0;
  if (view.mode == "ATTRIBUTES") {
    error = meshopt_decodeVertexBuffer(bytes.data(), view.count, view.stride, source, compressed.size());
  } else if (view.mode == "TRIANGLES") {
    error = meshopt_decodeIndexBuffer(bytes.data(), view.count, view.stride, source, compressed.size());
  } else {
    error = meshopt_decodeIndexSequence(bytes.data(), view.count, view.stride, source, compressed.size());
  }
  if (error != 0) extension.fail("the compressed data is broken (meshoptimizer's error " + std::to_string(error) + ")");
  if (view.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(bytes.data(), view.count, view.stride);
  if (view.filter == "QUATERNION") meshopt_decodeFilterQuat(bytes.data(), view.count, view.stride);
  if (view.filter == "EXPONENTIAL") meshopt_decodeFilterExp(bytes.data(), view.count, view.stride);
  return bytes;
}

}  // namespace sightline
