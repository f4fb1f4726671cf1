// The binned surface area heuristic (Wald 2007) in vectors of four floats: bounds as (x, y, z, unused), one pass over a
// range that fills the bins of all three axes, one that parts it. The same tree on every SIMD target.
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <vector>

#include "sightline/index/bvh_builders.hpp"
#include "sightline/index/large_pages.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/index/bvh_sah.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Four floats; one by one where the target has no vectors.
#if HWY_TARGET == HWY_SCALAR
struct Vec4 {
  float v[4];
};
template <class F>
HWY_INLINE Vec4 each4(F&& f) {
  return {{f(0), f(1), f(2), f(3)}};
}
HWY_INLINE Vec4 load4(const float* p) { return {{p[0], p[1], p[2], p[3]}}; }
HWY_INLINE void store4(Vec4 a, float* p) { std::copy(a.v, a.v + 4, p); }
HWY_INLINE Vec4 set4(float x) { return {{x, x, x, x}}; }
HWY_INLINE Vec4 min4(Vec4 a, Vec4 b) {
  return each4([&](int i) { return a.v[i] < b.v[i] ? a.v[i] : b.v[i]; });
}
HWY_INLINE Vec4 max4(Vec4 a, Vec4 b) {
  return each4([&](int i) { return a.v[i] > b.v[i] ? a.v[i] : b.v[i]; });
}
HWY_INLINE Vec4 sub4(Vec4 a, Vec4 b) {
  return each4([&](int i) { return a.v[i] - b.v[i]; });
}
HWY_INLINE Vec4 mul4(Vec4 a, Vec4 b) {
  return each4([&](int i) { return a.v[i] * b.v[i]; });
}
HWY_INLINE Vec4 sum_if_ordered(Vec4 lo, Vec4 hi) {
  return each4([&](int i) { return lo.v[i] <= hi.v[i] ? lo.v[i] + hi.v[i] : 0.0f; });
}
HWY_INLINE void to_bins(Vec4 place, float last, std::int32_t* bins) {
  for (int i = 0; i < 4; ++i) bins[i] = static_cast<std::int32_t>(place.v[i] < last ? place.v[i] : last);
}
#else
using Float4 = hn::FixedTag<float, 4>;
using Vec4 = hn::Vec<Float4>;
HWY_INLINE Vec4 load4(const float* p) { return hn::LoadU(Float4(), p); }
HWY_INLINE void store4(Vec4 a, float* p) { hn::StoreU(a, Float4(), p); }
HWY_INLINE Vec4 set4(float x) { return hn::Set(Float4(), x); }
HWY_INLINE Vec4 min4(Vec4 a, Vec4 b) { return hn::Min(a, b); }
HWY_INLINE Vec4 max4(Vec4 a, Vec4 b) { return hn::Max(a, b); }
HWY_INLINE Vec4 sub4(Vec4 a, Vec4 b) { return hn::Sub(a, b); }
HWY_INLINE Vec4 mul4(Vec4 a, Vec4 b) { return hn::Mul(a, b); }
HWY_INLINE Vec4 sum_if_ordered(Vec4 lo, Vec4 hi) { return hn::IfThenElseZero(hn::Le(lo, hi), hn::Add(lo, hi)); }
HWY_INLINE void to_bins(Vec4 place, float last, std::int32_t* bins) {
  const hn::RebindToSigned<Float4> di;
  hn::StoreU(hn::ConvertTo(di, hn::Min(place, set4(last))), di, bins);
}
#endif

/// A box and its number, which hides in the fourth component of lo.
struct alignas(32) Reference {
  float lo[4], hi[4];
};

struct alignas(16) Extent {
  float lo[4], hi[4];
};

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr int most_bins = 16;

HWY_INLINE void clear(Extent& e) {
  for (int i = 0; i < 4; ++i) {
    e.lo[i] = infinity;
    e.hi[i] = -infinity;
  }
}

HWY_INLINE float half_area(Vec4 lo, Vec4 hi) {
  float e[4];
  store4(sub4(hi, lo), e);
  return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
}

struct Task {
  std::uint32_t node, begin, end;
  Extent bounds, centres;  // of twice the centroids
};

struct Split {
  int axis = -1, bin = 0;
  float cost = infinity;
  Extent left, right;
};

class SahBuilder {
 public:
  SahBuilder(std::span<const Aabb> boxes, const BvhBuildConfig& config) : config_(config), references_(boxes.size()) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      Reference& r = references_[i];
      const Aabb& box = boxes[i];
      for (int axis = 0; axis < 3; ++axis) {
        r.lo[axis] = box.lo[axis];
        r.hi[axis] = box.hi[axis];
      }
      r.lo[3] = std::bit_cast<float>(static_cast<std::uint32_t>(i));
      r.hi[3] = 0.0f;
    }
  }

  Bvh build() {
    Bvh bvh;
    if (references_.empty()) return bvh;
    bvh.nodes.reserve(references_.size());
    bvh.nodes.emplace_back();
    std::vector<Task> stack;
    stack.push_back(whole());
    while (!stack.empty()) {
      const Task task = stack.back();
      stack.pop_back();
      BvhNode& node = bvh.nodes[task.node];
      node.bounds = {{task.bounds.lo[0], task.bounds.lo[1], task.bounds.lo[2]},
                     {task.bounds.hi[0], task.bounds.hi[1], task.bounds.hi[2]}};
      Task left, right;
      if (!part(task, left, right)) {
        node.first = task.begin;
        node.count = task.end - task.begin;
        continue;
      }
      const auto first = static_cast<std::uint32_t>(bvh.nodes.size());
      node.first = first;
      bvh.nodes.resize(bvh.nodes.size() + 2);
      left.node = first;
      right.node = first + 1;
      stack.push_back(right);
      stack.push_back(left);
    }
    bvh.items.reserve(references_.size());
    for (const Reference& r : references_) bvh.items.push_back(std::bit_cast<std::uint32_t>(r.lo[3]));
    return bvh;
  }

 private:
  /// Twice the centroid; 0 for an empty box.
  static HWY_INLINE Vec4 centre(const Reference& r) { return sum_if_ordered(load4(r.lo), load4(r.hi)); }

  [[nodiscard]] Task whole() const {
    Task task{};
    task.end = static_cast<std::uint32_t>(references_.size());
    measure(task);
    return task;
  }

  void measure(Task& task) const {
    Vec4 lo = set4(infinity), hi = set4(-infinity), clo = lo, chi = hi;
    for (std::uint32_t i = task.begin; i < task.end; ++i) {
      const Reference& r = references_[i];
      lo = min4(lo, load4(r.lo));
      hi = max4(hi, load4(r.hi));
      clo = min4(clo, centre(r));
      chi = max4(chi, centre(r));
    }
    store4(lo, task.bounds.lo);
    store4(hi, task.bounds.hi);
    store4(clo, task.centres.lo);
    store4(chi, task.centres.hi);
  }

  /// Parts the range of a task in two; false if it is to be a leaf.
  bool part(const Task& task, Task& left, Task& right) {
    const std::uint32_t count = task.end - task.begin;
    if (count <= 1) return false;
    const bool may_be_leaf = count <= static_cast<std::uint32_t>(config_.max_leaf_size);
    bins_ = count > 64 ? most_bins : count > 8 ? 8 : 4;
    Split split;
    find_split(task, split);
    if (may_be_leaf) {
      const float area = half_area(load4(task.bounds.lo), load4(task.bounds.hi));
      if (split.axis < 0 || !(split.cost + config_.node_cost * area < static_cast<float>(count) * area)) return false;
    }
    left.begin = task.begin;
    right.end = task.end;
    if (split.axis < 0) {  // all centroids coincide
      left.end = right.begin = task.begin + count / 2;
      measure(left);
      measure(right);
      return true;
    }
    left.bounds = split.left;
    right.bounds = split.right;
    left.end = right.begin = partition(task, split, left.centres, right.centres);
    return true;
  }

  /// How centroids become bins on an axis.
  struct Binning {
    float base[4], scale[4];
    float last;
  };
  [[nodiscard]] Binning binning(const Extent& centres) const {
    Binning b{};
    for (int axis = 0; axis < 3; ++axis) {
      const float extent = centres.hi[axis] - centres.lo[axis];
      b.base[axis] = centres.lo[axis];
      b.scale[axis] = extent > 0.0f && extent < infinity ? static_cast<float>(bins_) * 0.99999f / extent : 0.0f;
      if (!(b.scale[axis] < infinity)) b.scale[axis] = 0.0f;
    }
    b.last = static_cast<float>(bins_ - 1);
    return b;
  }
  static HWY_INLINE void bins_of(const Binning& b, const Reference& r, std::int32_t* HWY_RESTRICT bins) {
    to_bins(mul4(sub4(centre(r), load4(b.base)), load4(b.scale)), b.last, bins);
  }

  void find_split(const Task& task, Split& best) {
    const auto n = static_cast<std::size_t>(bins_);
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t b = 0; b < n; ++b) {
        clear(bin_[b][axis]);
        count_[axis][b] = 0;
      }
    const Binning binning_now = binning(task.centres);
    HWY_ALIGN std::int32_t bin[4];
    for (std::uint32_t i = task.begin; i < task.end; ++i) {
      const Reference& r = references_[i];
      bins_of(binning_now, r, bin);
      const Vec4 lo = load4(r.lo), hi = load4(r.hi);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        Extent& e = bin_[static_cast<std::size_t>(bin[axis])][axis];
        store4(min4(load4(e.lo), lo), e.lo);
        store4(max4(load4(e.hi), hi), e.hi);
        ++count_[axis][static_cast<std::size_t>(bin[axis])];
      }
    }
    for (int axis = 0; axis < 3; ++axis)
      if (binning_now.scale[axis] > 0.0f) sweep(axis, best);
    if (best.axis >= 0) bound_sides(best);
  }

  void sweep(int axis, Split& best) const {
    const auto a = static_cast<std::size_t>(axis), n = static_cast<std::size_t>(bins_);
    std::array<float, most_bins> right_cost{};
    Vec4 lo = set4(infinity), hi = set4(-infinity);
    std::uint32_t count = 0;
    for (std::size_t b = n - 1; b > 0; --b) {
      lo = min4(lo, load4(bin_[b][a].lo));
      hi = max4(hi, load4(bin_[b][a].hi));
      count += count_[a][b];
      right_cost[b] = count == 0 ? -1.0f : finite_area(lo, hi) * static_cast<float>(count);
    }
    lo = set4(infinity);
    hi = set4(-infinity);
    count = 0;
    for (std::size_t b = 0; b + 1 < n; ++b) {
      lo = min4(lo, load4(bin_[b][a].lo));
      hi = max4(hi, load4(bin_[b][a].hi));
      count += count_[a][b];
      if (count == 0 || right_cost[b + 1] < 0.0f) continue;
      const float cost = finite_area(lo, hi) * static_cast<float>(count) + right_cost[b + 1];
      if (best.axis < 0 || cost < best.cost) {
        best.axis = axis;
        best.bin = static_cast<int>(b);
        best.cost = cost;
      }
    }
  }

  /// Of empty boxes 0.
  static HWY_INLINE float finite_area(Vec4 lo, Vec4 hi) {
    const float area = half_area(lo, hi);
    return area >= 0.0f ? (area < infinity ? area : std::numeric_limits<float>::max()) : 0.0f;
  }

  void bound_sides(Split& split) const {
    const auto a = static_cast<std::size_t>(split.axis), n = static_cast<std::size_t>(bins_);
    for (const bool left : {true, false}) {
      const std::size_t from = left ? 0 : static_cast<std::size_t>(split.bin) + 1;
      const std::size_t to = left ? static_cast<std::size_t>(split.bin) + 1 : n;
      Vec4 lo = set4(infinity), hi = set4(-infinity);
      for (std::size_t b = from; b < to; ++b) {
        lo = min4(lo, load4(bin_[b][a].lo));
        hi = max4(hi, load4(bin_[b][a].hi));
      }
      Extent& side = left ? split.left : split.right;
      store4(lo, side.lo);
      store4(hi, side.hi);
    }
  }

  std::uint32_t partition(const Task& task, const Split& split, Extent& left, Extent& right) {
    const Binning binning_now = binning(task.centres);
    Vec4 llo = set4(infinity), lhi = set4(-infinity), rlo = llo, rhi = lhi;
    std::uint32_t i = task.begin, j = task.end;
    HWY_ALIGN std::int32_t bin[4];
    const auto is_left = [&](const Reference& r) HWY_ATTR {
      bins_of(binning_now, r, bin);
      return bin[split.axis] <= split.bin;
    };
    for (;;) {
      while (i < j && is_left(references_[i])) {
        llo = min4(llo, centre(references_[i]));
        lhi = max4(lhi, centre(references_[i]));
        ++i;
      }
      while (i < j && !is_left(references_[j - 1])) {
        rlo = min4(rlo, centre(references_[j - 1]));
        rhi = max4(rhi, centre(references_[j - 1]));
        --j;
      }
      if (i >= j) break;
      std::swap(references_[i], references_[j - 1]);
    }
    store4(llo, left.lo);
    store4(lhi, left.hi);
    store4(rlo, right.lo);
    store4(rhi, right.hi);
    return i;
  }

  BvhBuildConfig config_;
  PagedVector<Reference> references_;
  int bins_ = most_bins;
  Extent bin_[most_bins][3];
  std::uint32_t count_[3][most_bins] = {};
};

Bvh build_sah(std::span<const Aabb> boxes, const BvhBuildConfig& config) { return SahBuilder(boxes, config).build(); }

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {

HWY_EXPORT(build_sah);

Bvh build_bvh_sah(std::span<const Aabb> boxes, const BvhBuildConfig& config) {
  assert(config.max_leaf_size >= 1 && config.max_leaf_size <= 255);
  return HWY_DYNAMIC_DISPATCH(build_sah)(boxes, config);
}

}  // namespace sightline
#endif
