#include "picture.hpp"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "heat_picture.hpp"

namespace sightline::cli {
namespace {

constexpr glm::vec3 background{0.09f, 0.10f, 0.12f};

/// Unit normal of the triangle at a pixel in world space, turned towards the eye; zero for a triangle without area.
glm::vec3 facing_normal(const Scene& scene, const View& view, ObjectId id, std::uint32_t triangle) {
  const Mesh& mesh = scene.mesh_of(id);
  const Affine& transform = scene.objects()[id].transform;
  const glm::uvec3 corners = mesh.triangles[triangle];
  const glm::dvec3 a(transform_point(transform, mesh.positions[corners.x]));
  const glm::dvec3 b(transform_point(transform, mesh.positions[corners.y]));
  const glm::dvec3 c(transform_point(transform, mesh.positions[corners.z]));
  const glm::dvec3 cross = glm::cross(b - a, c - a);
  const double length = glm::length(cross);
  if (!(length > 0.0)) return glm::vec3(0.0f);
  const glm::dvec3 to_eye = view.projection == Projection::perspective ? view.eye - a : -view_direction(view);
  return glm::vec3(cross / (glm::dot(cross, to_eye) < 0.0 ? -length : length));
}

/// Light from the eye, from above, and a little from +x, so that no two walls of a box look the same.
glm::vec3 shaded_colour(const glm::vec3& normal, const glm::vec3& towards_eye) {
  const float from_eye = std::abs(glm::dot(normal, towards_eye));
  const float from_above = 0.5f + 0.5f * normal.y;
  const float from_side = 0.5f + 0.5f * normal.x;
  return glm::vec3(0.96f, 0.95f, 0.93f) * (0.08f + 0.42f * from_eye + 0.30f * from_above + 0.20f * from_side);
}

/// Hues apart by the golden ratio: neighbouring ids get colours that differ.
glm::vec3 object_colour(ObjectId id) {
  const double hue = std::fmod(static_cast<double>(id) * 0.6180339887498949, 1.0) * 6.0;
  const double value = 0.65 + 0.35 * std::fmod(static_cast<double>(id) * 0.7548776662466927, 1.0);
  const auto channel = [&](double shift) {
    const double k = std::fmod(shift + hue, 6.0);
    return static_cast<float>(value * (1.0 - 0.65 * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0)));
  };
  return {channel(5.0), channel(3.0), channel(1.0)};
}

struct DepthRange {
  float nearest = 0.0f, farthest = 0.0f;
};

DepthRange depth_range(const Frame& frame) {
  DepthRange range{std::numeric_limits<float>::infinity(), 0.0f};
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    if (frame.object[i] == no_object) continue;
    range.nearest = std::min(range.nearest, frame.depth[i]);
    range.farthest = std::max(range.farthest, frame.depth[i]);
  }
  return range;
}

glm::vec3 depth_colour(float depth, const DepthRange& range) {
  const float span = std::log(range.farthest / range.nearest);
  const float t = span > 0.0f ? std::log(depth / range.nearest) / span : 0.0f;
  return glm::vec3(1.0f - 0.8f * std::clamp(t, 0.0f, 1.0f));
}

glm::vec3 towards_eye(const View& view, int x, int y) {
  return glm::vec3(-glm::normalize(pixel_ray(view, x + 0.5, y + 0.5).direction));
}

}  // namespace

Picture paint(const Scene& scene, const View& view, const Frame& frame, Show show) {
  if (show == Show::overdraw)
    return paint_counts(frame.width, frame.height, std::span<const std::uint32_t>(frame.writes), most_layers_shown);
  if (show == Show::stencil)
    return paint_counts(frame.width, frame.height, std::span<const std::uint8_t>(frame.stencil), most_layers_shown);
  if (show == Show::tiles) return paint_tiles(view, frame);
  Picture picture{frame.width, frame.height, {}};
  picture.rgb.reserve(frame.object.size() * 3);
  const DepthRange range = depth_range(frame);
  const auto colour_at = [&](int x, int y) {
    const std::size_t i = frame.index(x, y);
    const ObjectId id = frame.object[i];
    if (id == no_object) return background;
    if (show == Show::object) return object_colour(id);
    if (show == Show::shaded && !frame.colour.empty()) {  // the renderer's own shading
      const std::uint32_t c = frame.colour[i];
      return glm::vec3(c & 255u, (c >> 8) & 255u, (c >> 16) & 255u) / 255.0f;
    }
    if (show == Show::depth) return depth_colour(frame.depth[i], range);
    const glm::vec3 normal = facing_normal(scene, view, id, frame.triangle[i]);
    return show == Show::normal ? 0.5f + 0.5f * normal : shaded_colour(normal, towards_eye(view, x, y));
  };
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      const glm::vec3 colour = glm::clamp(colour_at(x, y), 0.0f, 1.0f);
      for (int channel = 0; channel < 3; ++channel)
        picture.rgb.push_back(static_cast<std::uint8_t>(std::lround(colour[channel] * 255.0f)));
    }
  return picture;
}

Picture paint_overdraw(int width, int height, const std::vector<std::uint8_t>& surfaces) {
  static constexpr glm::vec3 steps[] = {{0.05f, 0.08f, 0.35f}, {0.05f, 0.35f, 0.75f}, {0.10f, 0.70f, 0.45f},
                                        {0.95f, 0.85f, 0.15f}, {0.90f, 0.25f, 0.10f}, {1.0f, 1.0f, 1.0f}};
  constexpr float last = static_cast<float>(std::size(steps) - 1);
  Picture picture{width, height, {}};
  picture.rgb.reserve(surfaces.size() * 3);
  for (const std::uint8_t count : surfaces) {
    glm::vec3 colour(0.0f);
    if (count > 0) {
      const float place = std::min(std::log2(static_cast<float>(count)), last);
      const auto below = static_cast<std::size_t>(std::min(place, last - 1.0f));
      colour = glm::mix(steps[below], steps[below + 1], place - static_cast<float>(below));
    }
    for (int channel = 0; channel < 3; ++channel)
      picture.rgb.push_back(static_cast<std::uint8_t>(std::lround(colour[channel] * 255.0f)));
  }
  return picture;
}

std::string encode_png(const Picture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.rgb.data(), 0, nullptr) == 0)
    throw std::runtime_error(std::string("PNG: ") + image.message);
  bytes.resize(size);
  return bytes;
}

}  // namespace sightline::cli
