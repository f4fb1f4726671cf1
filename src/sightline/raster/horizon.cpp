#include "sightline/raster/horizon.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/raster/horizon.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// True if every one of `count` intervals of slopes holds [low, high]. Both arrays are padded by 8.
bool all_hold(const float* lows, const float* highs, std::size_t count, float low, float high) {
  const hn::CappedTag<float, 8> d;
  const auto l = hn::Set(d, low), h = hn::Set(d, high);
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t c = 0; c < count; c += lanes) {
    const auto open = hn::Or(hn::Gt(hn::LoadU(d, lows + c), l), hn::Lt(hn::LoadU(d, highs + c), h));
    if (!hn::AllFalse(d, hn::And(open, hn::FirstN(d, count - c)))) return false;
  }
  return true;
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {

HWY_EXPORT(all_hold);

namespace {

constexpr double widest = 8;       // columns end where a direction is 83 degrees off the plan direction
constexpr double share = 1e-6;     // relative rounding that every comparison allows for
constexpr double steepest = 0.05;  // length of the plan direction below which there is no horizon

}  // namespace

bool Horizon::begin(const View& view, int columns) {
  perspective_ = view.projection == Projection::perspective;
  eye_ = view.eye;
  direction_ = view_direction(view);
  near_ = view.near;
  reach_ = glm::length(eye_);
  forward_ = {direction_.x, direction_.z};
  const double length = glm::length(forward_);
  if (length < steepest) return false;
  forward_ /= length;
  right_ = {-forward_.y, forward_.x};
  tilt_ = direction_.y / length;
  limit_ = 0;
  open_sides_ = false;
  for (const double x : {0.0, static_cast<double>(view.width)})
    for (const double y : {0.0, static_cast<double>(view.height)}) {
      const PixelRay ray = pixel_ray(view, x, y);
      const glm::dvec3 d = perspective_ ? ray.direction : ray.origin - eye_;
      const double across = glm::dot(right_, glm::dvec2(d.x, d.z)), along = glm::dot(forward_, glm::dvec2(d.x, d.z));
      if (!perspective_)
        limit_ = std::max(limit_, std::abs(across));
      else if (along * widest > std::abs(across))
        limit_ = std::max(limit_, std::abs(across) / along);
      else
        open_sides_ = true;
    }
  if (open_sides_) limit_ = widest;
  limit_ *= 1 + 1e-9;
  if (!(limit_ > 0)) return false;
  per_u_ = columns / (2 * limit_);
  columns_ = columns;
  low_.assign(static_cast<std::size_t>(columns) + 8, 3e38f);
  high_.assign(static_cast<std::size_t>(columns) + 8, -3e38f);
  return true;
}

HorizonBox Horizon::project(const Aabb& box) const {
  const double x0 = static_cast<double>(box.lo.x) - eye_.x, x1 = static_cast<double>(box.hi.x) - eye_.x;
  const double z0 = static_cast<double>(box.lo.z) - eye_.z, z1 = static_cast<double>(box.hi.z) - eye_.z;
  const double y0 = static_cast<double>(box.lo.y), y1 = static_cast<double>(box.hi.y);
  HorizonBox b{};
  const double fx0 = forward_.x * x0, fx1 = forward_.x * x1, fz0 = forward_.y * z0, fz1 = forward_.y * z1;
  b.nearest = std::min(fx0, fx1) + std::min(fz0, fz1);
  b.farthest = std::max(fx0, fx1) + std::max(fz0, fz1);
  b.askable = !perspective_ || b.nearest > 1e-3 * near_;
  if (!b.askable) return b;
  const double rx0 = right_.x * x0, rx1 = right_.x * x1, rz0 = right_.y * z0, rz1 = right_.y * z1;
  if (perspective_) {
    const double w[4] = {fx0 + fz0, fx1 + fz0, fx0 + fz1, fx1 + fz1};
    const double r[4] = {rx0 + rz0, rx1 + rz0, rx0 + rz1, rx1 + rz1};
    b.u0 = b.u1 = r[0] / w[0];
    for (int i = 1; i < 4; ++i) {
      const double u = r[i] / w[i];
      b.u0 = std::min(b.u0, u);
      b.u1 = std::max(b.u1, u);
    }
    const double z_near = 1 / b.nearest, z_far = 1 / b.farthest;
    b.v0 = (y0 - eye_.y) * (y0 < eye_.y ? z_near : z_far);
    b.v1 = (y1 - eye_.y) * (y1 > eye_.y ? z_near : z_far);
  } else {
    b.u0 = std::min(rx0, rx1) + std::min(rz0, rz1);
    b.u1 = std::max(rx0, rx1) + std::max(rz0, rz1);
    b.v0 = std::min(slope(y0, b.nearest), slope(y0, b.farthest));
    b.v1 = std::max(slope(y1, b.nearest), slope(y1, b.farthest));
  }
  return b;
}

HorizonQuery Horizon::query(const HorizonBox& box) const {
  if (!box.askable) return {};
  if (open_sides_ && (box.u0 < -limit_ || box.u1 > limit_)) return {};
  const double spread = share * (std::abs(box.u0) + std::abs(box.u1) + 1e-3 * limit_);
  const double most = static_cast<double>(columns());
  return {static_cast<std::uint16_t>(std::clamp((box.u0 - spread + limit_) * per_u_, 0.0, most - 1)),
          static_cast<std::uint16_t>(std::clamp((box.u1 + spread + limit_) * per_u_, 0.0, most - 1)),
          static_cast<float>(box.v0), static_cast<float>(box.v1)};
}

bool Horizon::hides(const HorizonQuery& query, std::uint64_t& cells) const {
  if (query.first > query.last) return false;
  const std::size_t count = std::size_t{query.last} - query.first + 1;
  cells += count;
  return HWY_DYNAMIC_DISPATCH(all_hold)(low_.data() + query.first, high_.data() + query.first, count, query.low,
                                        query.high);
}

Horizon::Point Horizon::point(const glm::dvec2& plan, double y0, double y1) const {
  const glm::dvec2 d = plan - glm::dvec2(eye_.x, eye_.z);
  const double w = glm::dot(forward_, d);
  const double level = direction_.x * d.x + direction_.z * d.y;
  const double nearest = level + std::min(direction_.y * (y0 - eye_.y), direction_.y * (y1 - eye_.y));
  Point p{};
  p.behind_near = nearest > near_ * (1 + share) + share * (std::abs(level) + std::abs(w));
  if (!perspective_) return {glm::dot(right_, d), w, p.behind_near};
  if (w < 1e-3 * near_) return {0, 0, false};
  p.z = 1 / w;
  p.u = glm::dot(right_, d) * p.z;
  return p;
}

void Horizon::add(const WallFence& fence, const glm::dvec3& offset, double slack) {
  points_.clear();
  const double y0 = fence.y0 + offset.y, y1 = fence.y1 + offset.y;
  for (const glm::dvec2& p : fence.plan) points_.push_back(point(p + glm::dvec2(offset.x, offset.z), y0, y1));
  // Runs that go one way across the columns, of walls behind the near plane.
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= points_.size(); ++i) {
    const bool usable = i < points_.size() && points_[i].behind_near && points_[i - 1].behind_near;
    const bool turns =
        usable && i - begin >= 2 && (points_[i].u > points_[i - 1].u) != (points_[begin + 1].u > points_[begin].u);
    if (usable && !turns) continue;
    if (i - begin >= 2) add_run(std::span(points_).subspan(begin, i - begin), y0, y1, slack);
    begin = turns ? i - 1 : i;
  }
}

void Horizon::add_run(std::span<const Point> run, double y0, double y1, double slack) {
  const bool rising = run.back().u > run.front().u;
  const auto at = [&](std::size_t i) -> const Point& { return rising ? run[i] : run[run.size() - 1 - i]; };
  double z_min = run.front().z, z_max = z_min;
  for (const Point& p : run) {
    z_min = std::min(z_min, p.z);
    z_max = std::max(z_max, p.z);
  }
  // The real walls end and stand up to `slack` aside, which looks this large.
  const double aside = perspective_ ? (slack + 1e-7 * reach_) * z_max : slack + 1e-7 * reach_;
  const double u0 = at(0).u + 4 * aside * (1 + std::abs(at(0).u)),
               u1 = at(run.size() - 1).u - 4 * aside * (1 + std::abs(at(run.size() - 1).u));
  const double most = static_cast<double>(columns());
  const double from = std::clamp(std::ceil((u0 + limit_) * per_u_ + share), 0.0, most);
  const double to = std::clamp(std::floor((u1 + limit_) * per_u_ - share), 0.0, most);
  if (!(from < to)) return;
  // The far walls of a house: nothing that nearer ones do not hide already.
  std::uint64_t cells = 0;
  if (hides({static_cast<std::uint16_t>(from), static_cast<std::uint16_t>(to - 1),
             static_cast<float>(std::min(slope(y0, z_min), slope(y0, z_max))),
             static_cast<float>(std::max(slope(y1, z_min), slope(y1, z_max)))},
            cells))
    return;
  const auto last = static_cast<int>(to);
  std::size_t piece = 0;  // the wall from at(piece) to at(piece + 1) holds the border
  double z_per_u = 0;     // of the piece
  const auto take_piece = [&] {
    const Point &a = at(piece), &b = at(piece + 1);
    z_per_u = b.u > a.u ? (b.z - a.z) / (b.u - a.u) : 0.0;
  };
  take_piece();
  const auto z_at = [&](double u) {
    for (; piece + 2 < run.size() && at(piece + 1).u < u; take_piece()) ++piece;
    const Point &a = at(piece), &b = at(piece + 1);
    return u >= b.u ? b.z : a.z + std::max(0.0, u - a.u) * z_per_u;
  };
  double left = z_at(border(static_cast<int>(from)));
  for (int c = static_cast<int>(from); c < last; ++c) {
    double z0 = left, z1 = left;
    const std::size_t before = piece;
    left = z_at(border(c + 1));
    for (std::size_t i = before + 1; i <= piece; ++i) {  // corners within the column
      z0 = std::min(z0, at(i).z);
      z1 = std::max(z1, at(i).z);
    }
    z0 = std::min(z0, left);
    z1 = std::max(z1, left);
    const double widening = share * (std::abs(z0) + std::abs(z1)) + (perspective_ ? aside * z1 : aside);
    z0 -= widening;
    z1 += widening;
    const double margin = 4 * aside + share * (std::abs(slope(y0, z1)) + std::abs(slope(y1, z1)));
    merge(c, std::max(slope(y0, z0), slope(y0, z1)) + margin, std::min(slope(y1, z0), slope(y1, z1)) - margin);
  }
}

void Horizon::merge(int column, double low, double high) {
  if (!(low < high)) return;
  float &a = low_[static_cast<std::size_t>(column)], &b = high_[static_cast<std::size_t>(column)];
  const auto l = static_cast<float>(low), h = static_cast<float>(high);
  if (a > b || (l <= b && h >= a)) {  // nothing yet, or the two touch
    if (a > b) {
      a = l;
      b = h;
    } else {
      a = std::min(a, l);
      b = std::max(b, h);
    }
  } else if (h - l > b - a) {  // apart: one interval is kept, the longer one
    a = l;
    b = h;
  }
}

}  // namespace sightline
#endif
