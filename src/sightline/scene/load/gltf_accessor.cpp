// Typed arrays of a glTF file (accessors), with sparse replacement and normalised integers.
#include "sightline/scene/load/gltf_accessor.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace sightline {

static_assert(sizeof(glm::vec3) == 3 * sizeof(float));

namespace {

constexpr std::uint64_t most_elements = 0xFFFFFFFFu;
constexpr std::uint64_t largest_stride = 65535;

std::size_t component_size(GltfComponent component) {
  switch (component) {
    case GltfComponent::int8:
    case GltfComponent::uint8:
      return 1;
    case GltfComponent::int16:
    case GltfComponent::uint16:
      return 2;
    default:
      return 4;
  }
}

GltfComponent component_of(const JsonObject& object) {
  const std::uint64_t code = object.required_integer("componentType");
  if (code < 5120 || code > 5126 || code == 5124) {
    object.fail("componentType", std::to_string(code) + " is no glTF component type");
  }
  return static_cast<GltfComponent>(code);
}

int components_of(const JsonObject& accessor) {
  const std::string& type = accessor.text("type");
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  accessor.fail("type", in_quotes(type) + " is none of SCALAR, VEC2, VEC3, VEC4");
}

/// Checks that the elements of `array` lie within its data. `stride` is set; the sizes cannot overflow (see the
/// limits).
void check_range(const GltfArray& array, std::uint64_t offset, const JsonObject& object) {
  if (array.count == 0) return;
  const std::size_t size = component_size(array.component) * static_cast<std::size_t>(array.components);
  const std::uint64_t needed = offset + (array.count - 1) * array.stride + size;
  if (needed > array.data.size()) {
    object.fail(std::to_string(array.count) + " elements need " + std::to_string(needed) +
                " bytes, the buffer view has " + std::to_string(array.data.size()));
  }
}

/// The part of a buffer view that `object` (an accessor, or half of a sparse one) describes.
void open_view(GltfDocument& document, const JsonObject& object, GltfArray& array, bool strided) {
  const std::optional<std::size_t> index = object.reference("bufferView", document.count("bufferViews"));
  const std::size_t size = component_size(array.component) * static_cast<std::size_t>(array.components);
  array.stride = size;
  if (!index) return;
  const JsonObject view = document.item("bufferViews", *index);
  if (const auto stride = view.integer("byteStride", largest_stride); stride && strided) {
    if (*stride < size) view.fail("byteStride", std::to_string(*stride) + " is less than the element size");
    array.stride = static_cast<std::size_t>(*stride);
  }
  array.data = document.view(*index);
  const std::uint64_t offset = object.integer("byteOffset").value_or(0);
  check_range(array, offset, object);
  array.data = array.count == 0 ? std::span<const std::byte>() : array.data.subspan(static_cast<std::size_t>(offset));
}

template <class From>
From element(const GltfArray& array, std::size_t i, std::size_t component) {
  From value;
  std::memcpy(&value, array.data.data() + i * array.stride + component * sizeof(From), sizeof(From));
  return value;
}

/// Integers that stand for fractions: 2^n - 1 steps to 1, the lowest signed value clamped (section 3.11).
template <class From>
float to_float(From value, bool normalized) {
  if constexpr (std::is_same_v<From, float>) {
    return value;
  } else {
    if (!normalized) return static_cast<float>(value);
    constexpr double one = std::numeric_limits<From>::max();
    return static_cast<float>(std::max(static_cast<double>(value) / one, -1.0));
  }
}

template <class From>
void convert_floats(const GltfArray& array, float* out) {
  const auto components = static_cast<std::size_t>(array.components);
  if (std::is_same_v<From, float> && array.stride == components * sizeof(float)) {
    std::memcpy(out, array.data.data(), array.count * array.stride);
    return;
  }
  for (std::size_t i = 0; i < array.count; ++i) {
    for (std::size_t c = 0; c < components; ++c) *out++ = to_float(element<From>(array, i, c), array.normalized);
  }
}

void convert_floats(const GltfArray& array, float* out) {
  if (array.data.empty()) return;
  switch (array.component) {
    case GltfComponent::int8:
      return convert_floats<std::int8_t>(array, out);
    case GltfComponent::uint8:
      return convert_floats<std::uint8_t>(array, out);
    case GltfComponent::int16:
      return convert_floats<std::int16_t>(array, out);
    case GltfComponent::uint16:
      return convert_floats<std::uint16_t>(array, out);
    case GltfComponent::uint32:
      return convert_floats<std::uint32_t>(array, out);
    case GltfComponent::float32:
      return convert_floats<float>(array, out);
  }
}

template <class From>
void convert_indices(const GltfArray& array, std::uint32_t* out) {
  for (std::size_t i = 0; i < array.count; ++i) out[i] = element<From>(array, i, 0);
}

/// False if the elements are no unsigned integers.
bool convert_indices(const GltfArray& array, std::uint32_t* out) {
  if (array.data.empty()) return true;
  if (array.component == GltfComponent::uint8) {
    convert_indices<std::uint8_t>(array, out);
  } else if (array.component == GltfComponent::uint16) {
    convert_indices<std::uint16_t>(array, out);
  } else if (array.component == GltfComponent::uint32) {
    convert_indices<std::uint32_t>(array, out);
  } else {
    return false;
  }
  return true;
}

/// Element numbers and new values of a sparse accessor.
struct SparsePart {
  std::vector<std::uint32_t> targets;
  GltfArray values;
};

SparsePart open_sparse(GltfDocument& document, const JsonObject& sparse, const GltfArray& base) {
  const auto count = static_cast<std::size_t>(sparse.required_integer("count", base.count));
  const std::optional<JsonObject> indices = sparse.object("indices");
  const std::optional<JsonObject> values = sparse.object("values");
  if (!indices || !values) sparse.fail("needs indices and values");
  if (!indices->has("bufferView")) indices->fail("bufferView", "is missing");
  if (!values->has("bufferView")) values->fail("bufferView", "is missing");

  GltfArray targets;
  targets.count = count;
  targets.component = component_of(*indices);
  open_view(document, *indices, targets, false);
  SparsePart part{{}, base};
  part.values.count = count;
  open_view(document, *values, part.values, false);

  document.spend(count * sizeof(std::uint32_t), sparse);
  part.targets.resize(count);
  if (!convert_indices(targets, part.targets.data())) indices->fail("componentType", "must be an unsigned integer");
  for (const std::uint32_t target : part.targets) {
    if (target >= base.count) indices->fail("element " + std::to_string(target) + " is beyond the accessor");
  }
  return part;
}

/// All elements of an accessor, sparse ones replaced, one `Number` for each component.
template <class Number, class Convert>
std::vector<Number> read_elements(GltfDocument& document, std::size_t index, const GltfArray& array, Convert convert) {
  const JsonObject accessor = document.item("accessors", index);
  const std::optional<JsonObject> sparse = accessor.object("sparse");
  const auto components = static_cast<std::size_t>(array.components);
  document.spend(std::uint64_t{array.count} * components * sizeof(Number), accessor);
  std::vector<Number> numbers(array.count * components);
  convert(array, numbers.data());
  if (!sparse) return numbers;
  const SparsePart part = open_sparse(document, *sparse, array);
  document.spend(std::uint64_t{part.targets.size()} * components * sizeof(Number), *sparse);
  std::vector<Number> values(part.targets.size() * components);
  convert(part.values, values.data());
  for (std::size_t i = 0; i < part.targets.size(); ++i) {
    std::copy_n(values.data() + i * components, components, numbers.data() + part.targets[i] * components);
  }
  return numbers;
}

}  // namespace

GltfArray open_accessor(GltfDocument& document, std::size_t index) {
  const JsonObject accessor = document.item("accessors", index);
  GltfArray array;
  array.count = static_cast<std::size_t>(accessor.required_integer("count", most_elements));
  array.component = component_of(accessor);
  array.components = components_of(accessor);
  array.normalized = accessor.flag("normalized");
  open_view(document, accessor, array, true);
  return array;
}

std::vector<float> read_floats(GltfDocument& document, std::size_t index, int components) {
  const JsonObject accessor = document.item("accessors", index);
  const GltfArray array = open_accessor(document, index);
  if (array.components != components) {
    accessor.fail("type", "must have " + std::to_string(components) + " components here");
  }
  std::vector<float> numbers =
      read_elements<float>(document, index, array, [](const GltfArray& a, float* out) { convert_floats(a, out); });
  // An exponent of all ones is infinity or NaN; the largest one tells for all of them, and the compiler can vectorise
  // it.
  std::uint32_t largest = 0;
  for (const float number : numbers) largest = std::max(largest, std::bit_cast<std::uint32_t>(number) & 0x7F800000u);
  if (largest == 0x7F800000u) {
    const auto bad = std::ranges::find_if(numbers, [](float number) { return !std::isfinite(number); });
    accessor.fail("element " + std::to_string((bad - numbers.begin()) / components) + " is not finite");
  }
  return numbers;
}

std::vector<glm::vec3> read_points(GltfDocument& document, std::size_t index) {
  const std::vector<float> numbers = read_floats(document, index, 3);
  std::vector<glm::vec3> points(numbers.size() / 3);
  if (!points.empty()) std::memcpy(&points[0][0], numbers.data(), numbers.size() * sizeof(float));
  return points;
}

std::vector<std::uint32_t> read_indices(GltfDocument& document, std::size_t index) {
  const JsonObject accessor = document.item("accessors", index);
  const GltfArray array = open_accessor(document, index);
  if (array.components != 1) accessor.fail("type", "indices must be SCALAR");
  const bool is_unsigned = array.component == GltfComponent::uint8 || array.component == GltfComponent::uint16 ||
                           array.component == GltfComponent::uint32;
  if (!is_unsigned) accessor.fail("componentType", "indices must be unsigned integers");
  return read_elements<std::uint32_t>(document, index, array,
                                      [](const GltfArray& a, std::uint32_t* out) { convert_indices(a, out); });
}

}  // namespace sightline
