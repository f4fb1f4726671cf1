#include "sightline/raster/tile_planes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sightline::raster::tile_planes {
namespace {

constexpr std::uint64_t every_pixel = ~std::uint64_t{0};

struct RealPlane {
  double z = 0, dx = 0, dy = 0;
  [[nodiscard]] double at(std::size_t i) const {
    return z + dx * static_cast<double>(i % 8) + dy * static_cast<double>(i / 8);
  }
};

/// Least squares through the pixels of `members`.
RealPlane least_squares(const DepthTile& tile, std::uint64_t members) {
  double n = 0, sx = 0, sy = 0, sz = 0, sxx = 0, sxy = 0, syy = 0, sxz = 0, syz = 0;
  const double origin = tile[static_cast<std::size_t>(std::countr_zero(members))];
  for (std::size_t i = 0; i < 64; ++i) {
    if (!has(members, i)) continue;
    const double x = static_cast<double>(i % 8), y = static_cast<double>(i / 8), z = tile[i] - origin;
    n += 1;
    sx += x;
    sy += y;
    sz += z;
    sxx += x * x;
    sxy += x * y;
    syy += y * y;
    sxz += x * z;
    syz += y * z;
  }
  const double axx = sxx - sx * sx / n, axy = sxy - sx * sy / n, ayy = syy - sy * sy / n;
  const double bx = sxz - sx * sz / n, by = syz - sy * sz / n, det = axx * ayy - axy * axy;
  RealPlane p;
  if (det > 1e-6) {
    p.dx = (bx * ayy - by * axy) / det;
    p.dy = (by * axx - bx * axy) / det;
  } else if (axx > 1e-6) {
    p.dx = bx / axx;
  } else if (ayy > 1e-6) {
    p.dy = by / ayy;
  }
  p.z = origin + (sz - p.dx * sx - p.dy * sy) / n;
  return p;
}

struct Spread {
  double least, most;
  std::size_t at_least, at_most;
};

/// Range of what the pixels lie above the plane.
Spread spread(const DepthTile& tile, std::uint64_t members, const RealPlane& p) {
  Spread s{1e300, -1e300, 0, 0};
  for (std::size_t i = 0; i < 64; ++i) {
    if (!has(members, i)) continue;
    const double above = tile[i] - p.at(i);
    if (above < s.least) s.least = above, s.at_least = i;
    if (above > s.most) s.most = above, s.at_most = i;
  }
  return s;
}

}  // namespace

tile_layout::Plane fit(const DepthTile& tile, std::uint64_t members) {
  RealPlane p = least_squares(tile, members), best = p;
  Spread s = spread(tile, members, p), best_spread = s;
  double step = 0.02;
  for (int round = 0; round < 16 && best_spread.most - best_spread.least >= 0.98; ++round, step *= 0.85) {
    const double tilt = step * std::min(s.most - s.least, 4.0) / 8.0;
    p.dx += tilt * (static_cast<double>(s.at_most % 8) - static_cast<double>(s.at_least % 8));
    p.dy += tilt * (static_cast<double>(s.at_most / 8) - static_cast<double>(s.at_least / 8));
    s = spread(tile, members, p);
    if (s.most - s.least < best_spread.most - best_spread.least) {
      best = p;
      best_spread = s;
    }
  }
  constexpr double one = 1 << tile_layout::fraction_bits, largest = (1 << 23) - 1;
  const auto slope = [&](double v) {
    return static_cast<std::int32_t>(std::clamp(std::round(v * one), -largest, largest));
  };
  tile_layout::Plane plane{0, slope(best.dx), slope(best.dy)};
  double least = 1e300, most = -1e300;
  for (std::size_t i = 0; i < 64; ++i) {
    if (!has(members, i)) continue;
    const double above =
        tile[i] * one - (plane.dx * static_cast<double>(i % 8) + plane.dy * static_cast<double>(i / 8));
    least = std::min(least, above);
    most = std::max(most, above);
  }
  const auto centre = static_cast<std::int64_t>(std::round(0.5 * (least + most + one - 1.0)));
  plane.z = static_cast<std::uint32_t>(centre);
  return plane;
}

std::uint64_t far_side(const DepthTile& tile) {
  DepthTile sorted = tile;
  std::sort(sorted.begin(), sorted.end());
  std::uint32_t gap = 0, first_far = 0;
  for (std::size_t i = 1; i < 64; ++i)
    if (sorted[i] - sorted[i - 1] > gap) {
      gap = sorted[i] - sorted[i - 1];
      first_far = sorted[i];
    }
  std::uint64_t far = 0;
  for (std::size_t i = 0; gap > 0 && i < 64; ++i) far |= tile[i] >= first_far ? std::uint64_t{1} << i : 0;
  return far;
}

std::uint64_t settled(const DepthTile& tile, std::uint64_t second) {
  for (int round = 0; round < 5; ++round) {
    if (second == 0 || second == every_pixel) return 0;
    const RealPlane a = least_squares(tile, ~second), b = least_squares(tile, second);
    std::uint64_t next = 0;
    for (std::size_t i = 0; i < 64; ++i)
      if (std::abs(tile[i] - b.at(i)) < std::abs(tile[i] - a.at(i))) next |= std::uint64_t{1} << i;
    if (next == second) break;
    second = next;
  }
  return second == every_pixel ? 0 : second;
}

}  // namespace sightline::raster::tile_planes
