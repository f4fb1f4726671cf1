// Typed arrays of a glTF file (accessors), with sparse replacement and normalised integers.
// Promise: every byte range is checked before anything is allocated; results are finite where they are floats.
// Source: glTF 2.0 specification, section 3.6.2.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "sightline/scene/load/gltf_document.hpp"

namespace sightline {

enum class GltfComponent { int8 = 5120, uint8 = 5121, int16 = 5122, uint16 = 5123, uint32 = 5125, float32 = 5126 };

/// Elements at a fixed stride within the file; `data` is empty where the accessor has no buffer view (all zero).
struct GltfArray {
  std::span<const std::byte> data;
  std::size_t count = 0;
  std::size_t stride = 0;
  int components = 1;
  GltfComponent component = GltfComponent::float32;
  bool normalized = false;
};

/// Accessor `index` with its ranges checked, before sparse replacement. Throws InputError.
GltfArray open_accessor(GltfDocument& document, std::size_t index);

/// All elements as floats, `components` numbers each: normalised integers mapped to [-1, 1] or [0, 1], others
/// converted. Throws InputError if the accessor has another number of components, or a value that is not finite.
std::vector<float> read_floats(GltfDocument& document, std::size_t index, int components);

/// All elements as points. Throws InputError as read_floats does.
std::vector<glm::vec3> read_points(GltfDocument& document, std::size_t index);

/// All elements as indices. Throws InputError if they are no scalar unsigned integers.
std::vector<std::uint32_t> read_indices(GltfDocument& document, std::size_t index);

}  // namespace sightline
