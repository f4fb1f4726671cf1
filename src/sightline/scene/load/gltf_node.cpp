// What a glTF node says besides its mesh and children: its place, instances, and the camera it carries.
#include "sightline/scene/load/gltf_node.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/gltf_accessor.hpp"

namespace sightline {

namespace {

constexpr int camera_height = 720;
constexpr double default_aspect = 16.0 / 9.0;

glm::dmat4 affine_matrix(const JsonObject& node, const std::array<double, 16>& values) {
  glm::dmat4 matrix;
  for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = values[static_cast<std::size_t>(i)];
  const glm::dvec4 last_row{matrix[0][3], matrix[1][3], matrix[2][3], matrix[3][3] - 1.0};
  if (!(glm::length(last_row) < 1e-6)) node.fail("matrix", "its last row must be 0 0 0 1");
  for (int column = 0; column < 4; ++column) matrix[column][3] = column == 3 ? 1.0 : 0.0;
  return matrix;
}

/// Translation * rotation * scale; nothing if the rotation, of any length above 0, is none.
std::optional<glm::dmat4> compose(const glm::dvec3& translation, const glm::dquat& rotation, const glm::dvec3& scale) {
  const double length = glm::length(rotation);
  if (!(length > 0.0) || !std::isfinite(length)) return std::nullopt;
  const glm::dmat3 axes = glm::mat3_cast(rotation / length);
  return glm::dmat4(glm::dvec4(axes[0] * scale.x, 0.0), glm::dvec4(axes[1] * scale.y, 0.0),
                    glm::dvec4(axes[2] * scale.z, 0.0), glm::dvec4(translation, 1.0));
}

/// An attribute of all instances; empty if the node does not have it.
std::vector<float> instance_attribute(GltfDocument& document, const JsonObject& attributes, std::string_view name,
                                      int components) {
  const auto accessor = attributes.reference(name, document.count("accessors"));
  return accessor ? read_floats(document, *accessor, components) : std::vector<float>();
}

}  // namespace

glm::dmat4 node_matrix(const JsonObject& node) {
  std::array<double, 16> matrix{};
  if (node.numbers("matrix", matrix)) return affine_matrix(node, matrix);
  std::array<double, 3> t{0.0, 0.0, 0.0}, s{1.0, 1.0, 1.0};
  std::array<double, 4> r{0.0, 0.0, 0.0, 1.0};
  node.numbers("translation", t);
  node.numbers("scale", s);
  node.numbers("rotation", r);
  const auto composed = compose({t[0], t[1], t[2]}, {r[3], r[0], r[1], r[2]}, {s[0], s[1], s[2]});
  if (!composed) node.fail("rotation", "is no rotation");
  return *composed;
}

std::uint64_t instance_count(const GltfDocument& document, const JsonObject& node) {
  const std::optional<JsonObject> extension = gltf_extension(node, "EXT_mesh_gpu_instancing");
  if (!extension) return 1;
  const std::optional<JsonObject> attributes = extension->object("attributes");
  if (!attributes) extension->fail("attributes", "is missing");
  std::uint64_t count = 0;
  for (const std::string_view name : {"TRANSLATION", "ROTATION", "SCALE"}) {
    const auto accessor = attributes->reference(name, document.count("accessors"));
    if (accessor) count = std::max(count, document.item("accessors", *accessor).required_integer("count", 0xFFFFFFFFu));
  }
  return count;
}

std::vector<glm::dmat4> instance_matrices(GltfDocument& document, const JsonObject& node) {
  const std::optional<JsonObject> extension = gltf_extension(node, "EXT_mesh_gpu_instancing");
  if (!extension) return {glm::dmat4(1.0)};
  const std::optional<JsonObject> attributes = extension->object("attributes");
  if (!attributes) extension->fail("attributes", "is missing");
  const std::vector<float> t = instance_attribute(document, *attributes, "TRANSLATION", 3);
  const std::vector<float> r = instance_attribute(document, *attributes, "ROTATION", 4);
  const std::vector<float> s = instance_attribute(document, *attributes, "SCALE", 3);
  const std::size_t count = std::max({t.size() / 3, r.size() / 4, s.size() / 3});
  const auto differs = [&](std::size_t other) { return other != 0 && other != count; };
  if (count == 0) attributes->fail("has neither TRANSLATION nor ROTATION nor SCALE");
  if (differs(t.size() / 3) || differs(r.size() / 4) || differs(s.size() / 3)) attributes->fail("counts differ");

  document.spend(count * sizeof(glm::dmat4), *extension);
  std::vector<glm::dmat4> matrices;
  matrices.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 translation = t.empty() ? glm::dvec3(0.0) : glm::dvec3(t[3 * i], t[3 * i + 1], t[3 * i + 2]);
    const glm::dvec3 scale = s.empty() ? glm::dvec3(1.0) : glm::dvec3(s[3 * i], s[3 * i + 1], s[3 * i + 2]);
    const glm::dquat rotation =
        r.empty() ? glm::dquat(1, 0, 0, 0) : glm::dquat(r[4 * i + 3], r[4 * i], r[4 * i + 1], r[4 * i + 2]);
    const auto matrix = compose(translation, rotation, scale);
    if (!matrix) attributes->fail("ROTATION", "element " + std::to_string(i) + " is no rotation");
    matrices.push_back(*matrix);
  }
  return matrices;
}

View moved_view(const View& lens, const glm::dmat4& world) {
  const View pose = look_along(glm::dvec3(world[3]), -glm::dvec3(world[2]), glm::dvec3(world[1]));
  View view = lens;
  view.eye = pose.eye;
  view.orientation = pose.orientation;
  check_view(view);
  return view;
}

View camera_view(const JsonObject& camera, const glm::dmat4& world) {
  const std::string& type = camera.text("type");
  const bool is_perspective = type == "perspective";
  if (!is_perspective && type != "orthographic") camera.fail("type", in_quotes(type) + " is no kind of camera");
  const std::optional<JsonObject> lens = camera.object(type);
  if (!lens) camera.fail(type, "is missing");
  double aspect = default_aspect;
  View view;
  try {
    view = look_along(glm::dvec3(world[3]), -glm::dvec3(world[2]), glm::dvec3(world[1]));
    view.near = lens->number("znear").value_or(view.near);
    if (is_perspective) {
      view.fov_y = lens->number("yfov").value_or(view.fov_y);
      view.far = lens->number("zfar").value_or(std::numeric_limits<double>::infinity());
      aspect = lens->number("aspectRatio").value_or(default_aspect);
    } else {
      view.projection = Projection::orthographic;
      view.far = lens->number("zfar").value_or(view.far);
      view.span_y = 2.0 * lens->number("ymag").value_or(0.0);
      aspect = 2.0 * lens->number("xmag").value_or(0.0) / view.span_y;
    }
    if (!(aspect > 0.0) || !std::isfinite(aspect)) throw InputError("the aspect ratio must be above 0");
    view.height = camera_height;
    view.width = static_cast<int>(std::clamp(std::round(camera_height * aspect), 1.0, 16384.0));
    check_view(view);
  } catch (const InputError& error) {
    if (!error.file().empty()) throw;
    camera.fail(error.reason());
  }
  return view;
}

}  // namespace sightline
