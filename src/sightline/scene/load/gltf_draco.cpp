// Triangles compressed by KHR_draco_mesh_compression, decoded by Google's Draco.
#include "sightline/scene/load/gltf_draco.hpp"

#include <draco/compression/decode.h>

#include <array>
#include <cmath>
#include <memory>

#include "sightline/scene/load/file_bytes.hpp"

namespace sightline {

namespace {

std::vector<glm::vec3> positions_of(const JsonObject& extension, const draco::PointAttribute& attribute) {
  std::vector<glm::vec3> points;
  points.reserve(attribute.size());
  for (draco::AttributeValueIndex i(0); i < static_cast<std::uint32_t>(attribute.size()); ++i) {
    std::array<float, 3> point{};
    if (!attribute.ConvertValue<float, 3>(i, point.data())) extension.fail("a position cannot be decoded");
    if (!std::isfinite(point[0]) || !std::isfinite(point[1]) || !std::isfinite(point[2])) {
      extension.fail("position " + std::to_string(i.value()) + " is not finite");
    }
    points.emplace_back(point[0], point[1], point[2]);
  }
  return points;
}

}  // namespace

Mesh decode_draco(const JsonObject& extension, std::span<const std::byte> compressed, std::uint32_t position) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(compressed.data()), compressed.size());
  draco::Decoder decoder;
  const draco::StatusOr<std::unique_ptr<draco::Mesh>> decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) extension.fail("the compressed data is broken: " + one_line(decoded.status().error_msg_string()));
  const draco::Mesh& source = *decoded.value();
  const draco::PointAttribute* attribute = source.GetAttributeByUniqueId(position);
  if (attribute == nullptr) extension.fail("attributes.POSITION", "the compressed mesh has no such attribute");
  if (attribute->num_components() != 3) extension.fail("attributes.POSITION", "must have three components");

  Mesh mesh;
  mesh.positions = positions_of(extension, *attribute);
  mesh.triangles.reserve(source.num_faces());
  for (draco::FaceIndex face(0); face < source.num_faces(); ++face) {
    glm::uvec3 triangle;
    for (int corner = 0; corner < 3; ++corner) {
      const draco::PointIndex point = source.face(face)[static_cast<std::size_t>(corner)];
      if (point >= source.num_points()) extension.fail("a face has a corner beyond the points");
      triangle[corner] = attribute->mapped_index(point).value();
      if (triangle[corner] >= mesh.positions.size()) extension.fail("a face has a corner beyond the positions");
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace sightline
