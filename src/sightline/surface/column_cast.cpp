#include "sightline/surface/column_cast.hpp"

#include <algorithm>
#include <cmath>

#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

constexpr int texels = 64;

std::uint32_t grain(int u, int v, std::uint32_t kind) {
  std::uint32_t h =
      static_cast<std::uint32_t>(u) * 0x9E3779B1u ^ static_cast<std::uint32_t>(v) * 0x85EBCA77u ^ kind * 0xC2B2AE3Du;
  h ^= h >> 15;
  h *= 0x2C1B3C6Du;
  return (h ^ (h >> 13)) % 24u;
}

glm::ivec3 texel(int u, int v, int kind) {
  switch (kind) {
    case 0:
      return (u / 32 + v / 32) % 2 == 0 ? glm::ivec3(96, 92, 84) : glm::ivec3(112, 108, 98);  // floor
    case 5:
      return v % 32 < 2 || u % 32 < 2 ? glm::ivec3(66, 58, 50) : glm::ivec3(92, 82, 72);  // ceiling
    case 1:                                                                               // bricks
      return v % 16 < 2 || (u + (v / 16 % 2) * 16) % 32 < 2 ? glm::ivec3(120, 112, 104) : glm::ivec3(150, 62, 48);
    case 2:
      return v % 32 < 2 || u % 32 < 2 ? glm::ivec3(72, 78, 92) : glm::ivec3(112, 122, 142);  // stone
    case 3:
      return u % 16 < 2 ? glm::ivec3(84, 58, 34) : glm::ivec3(138, 100, 58);  // planks
    default:
      return (u / 8 + v / 8) % 2 == 0 ? glm::ivec3(52, 92, 78) : glm::ivec3(64, 112, 94);  // tiles
  }
}

/// u, v in [0, 1) within a cell; darker with distance and on walls across z.
std::uint32_t textured(double u, double v, int kind, double distance, bool dim) {
  const int iu = std::clamp(static_cast<int>(u * texels), 0, texels - 1);
  const int iv = std::clamp(static_cast<int>(v * texels), 0, texels - 1);
  const glm::ivec3 base = texel(iu, iv, kind) + static_cast<int>(grain(iu, iv, static_cast<std::uint32_t>(kind))) - 12;
  const double light = (dim ? 0.72 : 1.0) / (1.0 + 0.05 * distance);
  std::uint32_t result = 0xFF000000u;
  for (int i = 0; i < 3; ++i) result |= static_cast<std::uint32_t>(std::clamp(base[i] * light, 0.0, 255.0)) << (8 * i);
  return result;
}

double fraction(double x) { return x - std::floor(x); }

/// The wall that a column sees.
struct WallHit {
  bool found = false;
  double t = 0.0;  // along the ray, whose component along the view direction is 1: the distance without fisheye
  int x = 0, z = 0;
  bool across_z = false;  // the face looks along z
};

/// The walk of Amanatides and Woo from cell to cell, origin and direction in cells.
WallHit walk(const GridMap& map, const glm::dvec2& origin, const glm::dvec2& direction, double t_max,
             std::uint64_t& steps) {
  int x = static_cast<int>(std::floor(origin.x)), z = static_cast<int>(std::floor(origin.y));
  const int step_x = direction.x < 0.0 ? -1 : 1, step_z = direction.y < 0.0 ? -1 : 1;
  const auto crossing = [](double from, double slope, int line) { return (line - from) / slope; };
  while (true) {
    // From the line's own place, not by adding up: no drift over long walks.
    const double tx = direction.x == 0.0 ? 1e300 : crossing(origin.x, direction.x, x + (step_x > 0 ? 1 : 0));
    const double tz = direction.y == 0.0 ? 1e300 : crossing(origin.y, direction.y, z + (step_z > 0 ? 1 : 0));
    const bool over_x = tx <= tz;
    const double t = over_x ? tx : tz;
    if (!(t < t_max)) return {};
    (over_x ? x : z) += over_x ? step_x : step_z;
    ++steps;
    if (map.at(x, z) != 0) return {true, t, x, z, !over_x};
    const bool gone = (step_x > 0 ? x >= map.width : x < 0) || (step_z > 0 ? z >= map.depth : z < 0);
    if (gone) return {};
  }
}

class Caster {
 public:
  Caster(const GridMap& map, const View& view, const ColumnCastConfig& config, Frame& frame)
      : map_(map), view_(view), config_(config), frame_(frame), objects_(wall_objects(map)) {
    const glm::dvec3 look = view_direction(view);
    const glm::dvec3 up = view.orientation * glm::dvec3(0, 1, 0);
    if (view.projection != Projection::perspective || std::abs(look.y) > 1e-6 || up.y < 1.0 - 1e-6)
      throw InputError("column_cast: the view must be in perspective, look horizontally and stand upright");
    if (!(view.eye.y > 0.0 && view.eye.y < static_cast<double>(map.height)))
      throw InputError("column_cast: the eye must lie between floor and ceiling");
    const glm::dvec2 place(view.eye.x / static_cast<double>(map.cell), view.eye.z / static_cast<double>(map.cell));
    if (map.at(static_cast<int>(std::floor(place.x)), static_cast<int>(std::floor(place.y))) != 0)
      throw InputError("column_cast: the eye lies in a wall");
    for (int y = 0; y < view.height; ++y) rises_.push_back(pixel_ray(view, 0.5, y + 0.5).direction.y);
    floor_ = static_cast<ObjectId>(std::count_if(map.walls.begin(), map.walls.end(), [](auto w) { return w != 0; }));
  }

  void column(int x, Counters& counters) {
    const PixelRay pixel = pixel_ray(view_, x + 0.5, 0.5 * view_.height);
    const double cell = map_.cell;
    const glm::dvec2 origin(pixel.origin.x / cell, pixel.origin.z / cell);
    const glm::dvec2 direction(pixel.direction.x / cell, pixel.direction.z / cell);
    const WallHit wall = walk(map_, origin, direction, view_.far, counters.nodes_visited);
    // The distance along the ray is longer than that along the view direction by the secant of the angle.
    const double secant = glm::length(glm::dvec2(pixel.direction.x, pixel.direction.z));
    const double stretch = config_.correct_fisheye ? 1.0 : secant;
    for (int y = 0; y < view_.height; ++y) {
      const double rise = rises_[static_cast<std::size_t>(y)];
      // Height on the wall at the distance that the picture takes for it; what lies beyond is floor or ceiling.
      const double height = wall.found ? view_.eye.y + rise * wall.t * stretch : 0.0;
      const bool on_wall = wall.found && height >= 0.0 && height <= static_cast<double>(map_.height);
      if (on_wall)
        put_wall(x, y, wall, origin + wall.t * direction, height, wall.t * stretch);
      else
        put_plane(x, y, rise, origin, direction, stretch);
      ++counters.pixels_tested;
    }
  }

 private:
  void put(int x, int y, double depth, ObjectId object, std::uint32_t colour) {
    if (depth < view_.near || depth > view_.far) return;
    const std::size_t at = frame_.index(x, y);
    frame_.depth[at] = static_cast<float>(depth);
    frame_.object[at] = object;
    if (config_.textured) frame_.colour[at] = colour;
  }

  void put_wall(int x, int y, const WallHit& wall, const glm::dvec2& place, double height, double depth) {
    const double u = fraction(wall.across_z ? place.x : place.y);
    const double v = 1.0 - height / static_cast<double>(map_.height);
    put(x, y, depth, objects_[map_.index(wall.x, wall.z)],
        config_.textured ? textured(u, v, map_.at(wall.x, wall.z), depth, wall.across_z) : 0);
  }

  void put_plane(int x, int y, double rise, const glm::dvec2& origin, const glm::dvec2& direction, double stretch) {
    if (rise == 0.0) return;
    const bool ceiling = rise > 0.0;
    const double depth = ((ceiling ? static_cast<double>(map_.height) : 0.0) - view_.eye.y) / rise;
    const glm::dvec2 place = origin + depth / stretch * direction;
    if (!(place.x >= 0.0 && place.y >= 0.0 && place.x <= map_.width && place.y <= map_.depth)) return;
    put(x, y, depth, floor_ + (ceiling ? 1 : 0),
        config_.textured ? textured(fraction(place.x), fraction(place.y), ceiling ? 5 : 0, depth, false) : 0);
  }

  const GridMap& map_;
  const View& view_;
  const ColumnCastConfig config_;
  Frame& frame_;
  const std::vector<ObjectId> objects_;
  std::vector<double> rises_;  // by row: how the rays climb for a metre along the view direction
  ObjectId floor_ = 0;
};

}  // namespace

void column_cast(const GridMap& map, const View& view, const ColumnCastConfig& config, Frame& frame,
                 Counters& counters) {
  check_grid_map(map);
  check_view(view);
  frame.clear(view.width, view.height);
  if (config.textured) frame.colour.assign(frame.object.size(), 0xFF282420u);
  Caster caster(map, view, config, frame);
  for (int x = 0; x < view.width; ++x) caster.column(x, counters);
  for (const ObjectId id : frame.object) counters.pixels_written += id != no_object ? 1 : 0;
}

}  // namespace sightline
