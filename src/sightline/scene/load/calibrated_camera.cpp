// Cameras from JSON; the format is described at read_cameras.
#include "sightline/scene/calibrated_camera.hpp"

#include <array>
#include <cmath>
#include <optional>

#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/file_bytes.hpp"
#include "sightline/scene/load/json_object.hpp"
#include "sightline/scene/load/readers.hpp"

namespace sightline {
namespace {

constexpr std::uint64_t most_pixels = 32768;

template <std::size_t n>
std::optional<std::array<double, n>> numbers(const JsonObject& object, std::string_view field) {
  std::array<double, n> values{};
  if (!object.numbers(field, values)) return std::nullopt;
  return values;
}

std::optional<glm::dvec3> vector(const JsonObject& object, std::string_view field) {
  const auto v = numbers<3>(object, field);
  if (!v) return std::nullopt;
  return glm::dvec3((*v)[0], (*v)[1], (*v)[2]);
}

double required(const JsonObject& object, std::string_view field) {
  const auto value = object.number(field);
  if (!value) object.fail(field, "is missing");
  return *value;
}

/// Rows x (right), y (down), z (forward) of a camera that looks along `forward`.
glm::dmat3 looking(const JsonObject& object, glm::dvec3 forward, glm::dvec3 up) {
  if (!(glm::length(forward) > 0.0)) object.fail("look", "has no length");
  forward = glm::normalize(forward);
  if (!(glm::length(up) > 0.0)) object.fail("up", "has no length");
  up = glm::normalize(up);
  if (glm::length(glm::cross(forward, up)) < 1e-6)
    up = std::abs(forward.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, forward.y > 0 ? 1 : -1);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, up));
  return glm::transpose(glm::dmat3(right, glm::cross(forward, right), forward));
}

glm::dmat3 from_rows(const double* r, std::size_t stride) {
  return glm::transpose(glm::dmat3(glm::dvec3(r[0], r[1], r[2]), glm::dvec3(r[stride], r[stride + 1], r[stride + 2]),
                                   glm::dvec3(r[2 * stride], r[2 * stride + 1], r[2 * stride + 2])));
}

/// camera = R world + t.
void set_extrinsics(CalibratedCamera& camera, const glm::dmat3& rotation, const glm::dvec3& translation) {
  camera.rotation = rotation;
  camera.centre = -(glm::transpose(rotation) * translation);
}

void read_pose(const JsonObject& object, CalibratedCamera& camera) {
  const bool by_eye = object.has("eye"), by_quaternion = object.has("qvec"), by_matrix = object.has("rotation"),
             by_inverse = object.has("camera_to_world");
  if (by_eye + by_quaternion + by_matrix + by_inverse != 1)
    object.fail("needs one pose: eye with look or target, qvec and tvec, rotation and translation, or camera_to_world");
  const auto partner = [&](std::string_view field) {
    const auto v = vector(object, field);
    if (!v) object.fail(field, "is missing");
    return *v;
  };
  if (by_eye) {
    camera.centre = *vector(object, "eye");
    const auto look = vector(object, "look"), target = vector(object, "target");
    if (look.has_value() == target.has_value()) object.fail("needs a look or a target");
    camera.rotation = looking(object, look ? *look : *target - camera.centre,
                              vector(object, "up").value_or(glm::dvec3(0.0, 1.0, 0.0)));
  } else if (by_quaternion) {
    const auto q = *numbers<4>(object, "qvec");
    const glm::dquat turn(q[0], q[1], q[2], q[3]);
    if (!(std::abs(glm::length(turn) - 1.0) <= 1e-3)) object.fail("qvec", "is no unit quaternion");
    set_extrinsics(camera, glm::mat3_cast(glm::normalize(turn)), partner("tvec"));
  } else if (by_matrix) {
    set_extrinsics(camera, from_rows(numbers<9>(object, "rotation")->data(), 3), partner("translation"));
  } else {
    const auto m = *numbers<16>(object, "camera_to_world");
    camera.rotation = glm::transpose(from_rows(m.data(), 4));
    camera.centre = {m[3], m[7], m[11]};
  }
}

void read_intrinsics(const JsonObject& object, CalibratedCamera& camera) {
  camera.width = static_cast<int>(object.required_integer("width", most_pixels));
  camera.height = static_cast<int>(object.required_integer("height", most_pixels));
  const std::string& model = object.has("model") ? object.text("model") : std::string("pinhole");
  if (model == "orthographic") {
    const double span = required(object, "span_y");
    if (!(span > 0.0)) object.fail("span_y", "is not above 0");
    camera.projection = Projection::orthographic;
    camera.fx = camera.fy = camera.height / span;
  } else if (model == "pinhole") {
    camera.fx = required(object, "fx");
    camera.fy = object.number("fy").value_or(camera.fx);
  } else {
    object.fail("model", "'" + model + "' is not pinhole or orthographic");
  }
  camera.cx = object.number("cx").value_or(0.5 * camera.width);
  camera.cy = object.number("cy").value_or(0.5 * camera.height);
  camera.near = object.number("near").value_or(camera.near);
  camera.far = object.number("far").value_or(camera.far);
}

}  // namespace

std::vector<CalibratedCamera> read_cameras(const std::filesystem::path& file) {
  return parse_cameras(file, read_file(file));
}

std::vector<CalibratedCamera> parse_cameras(const std::filesystem::path& file, const Bytes& bytes) {
  const std::string name = file.string();
  const nlohmann::json json = parse_json(name, bytes);
  const JsonObject root(json, name, "");
  std::vector<CalibratedCamera> cameras;
  for (std::size_t i = 0; i < root.count("cameras"); ++i) {
    const JsonObject object = root.item("cameras", i);
    CalibratedCamera camera;
    camera.name = object.has("name") ? object.text("name") : std::to_string(i);
    read_intrinsics(object, camera);
    read_pose(object, camera);
    try {
      check_camera(camera);
    } catch (const InputError& error) {
      object.fail(error.reason());
    }
    cameras.push_back(std::move(camera));
  }
  if (cameras.empty()) throw InputError(name, "", "has no cameras");
  return cameras;
}

}  // namespace sightline
