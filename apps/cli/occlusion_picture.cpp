#include "occlusion_picture.hpp"

#include <algorithm>
#include <cmath>

#include "sightline/oracle/oracle.hpp"
#include "sightline/raster/horizon.hpp"
#include "sightline/raster/occlusion_buffer.hpp"
#include "sightline/raster/overlap_pyramid.hpp"

namespace sightline::cli {
namespace {

Picture draw(const Scene& scene, const View& view, Show show) {
  Frame frame;
  Oracle(scene).draw(view, frame);
  return paint(scene, view, frame, show);
}

void blend(Picture& picture, int x, int y, const glm::vec3& colour, float share) {
  for (int c = 0; c < 3; ++c) {
    std::uint8_t& value = picture.rgb[static_cast<std::size_t>((y * picture.width + x) * 3 + c)];
    value = static_cast<std::uint8_t>(std::lround((1 - share) * static_cast<float>(value) + share * 255 * colour[c]));
  }
}

Picture beside(const Picture& left, const Picture& right) {
  constexpr int gap = 4;
  Picture both{left.width + gap + right.width, std::max(left.height, right.height), {}};
  both.rgb.assign(static_cast<std::size_t>(both.width) * static_cast<std::size_t>(both.height) * 3, 255);
  const auto copy = [&](const Picture& from, int at) {
    for (int y = 0; y < from.height; ++y)
      std::copy_n(from.rgb.begin() + static_cast<std::ptrdiff_t>(y) * from.width * 3, from.width * 3,
                  both.rgb.begin() + (static_cast<std::ptrdiff_t>(y) * both.width + at) * 3);
  };
  copy(left, 0);
  copy(right, left.width + gap);
  return both;
}

/// Every wall of every opaque object, nearest first.
Horizon horizon_of(const Scene& scene, const View& view) {
  Horizon horizon;
  if (!horizon.begin(view, view.width)) return horizon;
  const BoxArrays bounds(scene.object_bounds());
  std::vector<HorizonBox> boxes(bounds.count);
  Counters unused;
  boxes.resize(boxes_over_horizon(horizon.plan(), bounds, 0, bounds.count, {}, 0, boxes.data(), unused));
  std::stable_sort(boxes.begin(), boxes.end(),
                   [](const HorizonBox& a, const HorizonBox& b) { return a.farthest < b.farthest; });
  for (const HorizonBox& box : boxes) {
    const ObjectId id = box.index;
    if (!scene.objects()[id].opaque) continue;
    const Object& object = scene.objects()[id];
    const WallFences set = find_wall_fences(scene.mesh_of(id), glm::dmat3(to_matrix(object.transform)));
    for (const WallFence& fence : set.fences) horizon.add(fence, glm::dvec3(object.transform[3]), set.slack);
  }
  return horizon;
}

Picture picture_horizon(const Scene& scene, const View& view) {
  Picture picture = draw(scene, view, Show::shaded);
  const Horizon horizon = horizon_of(scene, view);
  if (horizon.columns() == 0) return picture;
  const glm::dvec3 direction = view_direction(view);
  const glm::dvec2 forward = glm::normalize(glm::dvec2(direction.x, direction.z)), right(-forward.y, forward.x);
  const double per_column = horizon.border(1) - horizon.border(0);
  for (int x = 0; x < view.width; ++x) {
    bool above = true;
    for (int y = 0; y < view.height; ++y) {
      const glm::dvec3 d = pixel_ray(view, x + 0.5, y + 0.5).direction;
      const double along = glm::dot(forward, glm::dvec2(d.x, d.z));
      if (along <= 0) continue;
      const double u = glm::dot(right, glm::dvec2(d.x, d.z)) / along, v = d.y / along;
      const int column = static_cast<int>(std::floor((u - horizon.border(0)) / per_column));
      if (column < 0 || column >= horizon.columns()) continue;
      const bool hidden =
          v >= static_cast<double>(horizon.low(column)) && v <= static_cast<double>(horizon.high(column));
      if (hidden)
        blend(picture, x, y, above ? glm::vec3(1, 0.1f, 0.2f) : glm::vec3(0.1f, 0.4f, 1), above ? 1.0f : 0.4f);
      if (hidden && above && y + 1 < view.height) blend(picture, x, y + 1, {1, 0.1f, 0.2f}, 1);
      above = above && !hidden;
    }
  }
  return picture;
}

Picture picture_overlap(const Scene& scene, const View& view) {
  OcclusionBuffer buffer;
  buffer.begin(view, view.width, view.height);
  for (const Object& object : scene.objects())
    if (object.opaque && object.bounds.extent().y > 3) {  // the ground would make all of it white
      const Mesh& mesh = scene.meshes()[object.mesh];
      buffer.add_occluder(make_occluder(mesh.positions, mesh.triangles), object.transform);
    }
  OverlapPyramid pyramid;
  pyramid.reset(view.width, view.height);
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x)
      if (std::isfinite(buffer.hidden_beyond(x, y))) pyramid.cover(x, y);
  pyramid.build();
  const auto level_picture = [&](int level, int scale) {
    Picture picture{pyramid.level_width(level) * scale, pyramid.level_height(level) * scale, {}};
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const auto grey = static_cast<std::uint8_t>(std::lround(255 * pyramid.opacity(level, x / scale, y / scale)));
        for (int c = 0; c < 3; ++c) picture.rgb.push_back(grey);
      }
    return picture;
  };
  Picture all = level_picture(0, 1);
  for (const int level : {3, 5})
    if (level < pyramid.level_count()) all = beside(all, level_picture(level, 1 << level));
  return all;
}

}  // namespace

Picture picture_occlusion(const Scene& scene, const Scene& occluders, const View& view, OcclusionShow show) {
  switch (show) {
    case OcclusionShow::horizon:
      return picture_horizon(scene, view);
    case OcclusionShow::overlap:
      return picture_overlap(scene, view);
    case OcclusionShow::occluders:
      break;
  }
  return beside(draw(scene, view, Show::shaded), draw(occluders, view, Show::object));
}

}  // namespace sightline::cli
