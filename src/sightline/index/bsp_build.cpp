// The builder of bsp.hpp: lists of fragments on a stack, a plane for each, the parts on the stack again.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "sightline/geometry/pca.hpp"
#include "sightline/index/bsp.hpp"

namespace sightline {
namespace {

/// SplitMix64 (Steele, Lea and Flood 2014).
std::uint64_t scramble(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

using List = std::vector<std::uint32_t>;

/// A list of fragments that becomes the subtree at one side of a node.
struct Task {
  List list;
  std::uint32_t parent;
  bool front;
  std::size_t depth;
  double share;  // of all the work
};

struct Score {
  std::size_t front = 0, back = 0, splits = 0, on = 0;
};

/// A plane to split at, and the fragment whose plane it is, if any.
struct Choice {
  BspPlane plane;
  std::uint32_t owner = no_owner;
  static constexpr std::uint32_t no_owner = 0xFFFFFFFFu;
};

class Builder {
 public:
  Builder(PolygonSet polygons, const BspConfig& config) : config_(config) {
    bsp_.polygons = std::move(polygons);
    double reach = 0.0;
    for (const glm::dvec3& p : bsp_.polygons.corners)
      reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    bsp_.tolerance = std::max(config.relative_tolerance * reach, std::numeric_limits<double>::min());
  }

  Bsp build() {
    List all;
    for (std::size_t i = 0; i < bsp_.polygons.size(); ++i) {
      const BspPlane plane = plane_of(bsp_.polygons[i]);
      bsp_.planes.push_back(plane);
      if (plane.normal == glm::dvec3(0.0)) {
        ++bsp_.dropped;
        continue;
      }
      all.push_back(static_cast<std::uint32_t>(fragments_.size()));
      fragments_.push_back({static_cast<std::uint32_t>(corners_.size()),
                            static_cast<std::uint32_t>(bsp_.polygons[i].size()), static_cast<std::uint32_t>(i), true});
      for (const glm::dvec3& p : bsp_.polygons[i]) corners_.push_back({p, no_cut});
    }
    if (!all.empty()) tasks_.push_back({std::move(all), 0, true, 1, 1.0});
    while (!tasks_.empty()) {
      Task task = std::move(tasks_.back());
      tasks_.pop_back();
      make_node(task);
      constexpr std::size_t nodes_between_calls = 256;
      if (config_.go_on && bsp_.nodes.size() % nodes_between_calls == 0 && !config_.go_on(done_))
        throw std::length_error("the BSP tree was given up");
    }
    return std::move(bsp_);
  }

 private:
  void make_node(Task& task) {
    const auto index = static_cast<std::uint32_t>(bsp_.nodes.size());
    if (index > 0) {
      BspNode& parent = bsp_.nodes[task.parent];
      (task.front ? parent.front : parent.back) = index;
    }
    bsp_.depth = std::max(bsp_.depth, task.depth);
    const Choice choice = choose(task.list, index);
    List front, back, on;
    for (const std::uint32_t id : task.list)
      if (id == choice.owner)
        on.push_back(id);
      else
        part(id, choice.plane, index, front, back, on);
    bsp_.nodes.emplace_back();
    bsp_.nodes.back().plane = choice.plane;
    place(on, index);
    // Lists of n fragments take about n log n.
    const auto work = [](const List& list) {
      return static_cast<double>(list.size()) * std::log2(static_cast<double>(list.size()) + 1.0);
    };
    const double rest = work(front) + work(back),
                 left = task.share * rest / (rest + static_cast<double>(on.size() + 1));
    done_ += task.share - left;
    if (!front.empty()) {
      const double share = left * work(front) / rest;
      tasks_.push_back({std::move(front), index, true, task.depth + 1, share});
    }
    if (!back.empty()) {
      const double share = left * work(back) / rest;
      tasks_.push_back({std::move(back), index, false, task.depth + 1, share});
    }
  }

  void part(std::uint32_t id, const BspPlane& plane, std::uint32_t node, List& front, List& back, List& on) {
    const BspFragment fragment = fragments_[id];
    const std::span<const BspCorner> corners = std::span(corners_).subspan(fragment.first, fragment.count);
    switch (split_polygon(corners, plane, node, bsp_.tolerance, front_part_, back_part_)) {
      case BspSide::on:
        on.push_back(id);
        break;
      case BspSide::front:
        front.push_back(id);
        break;
      case BspSide::back:
        back.push_back(id);
        break;
      case BspSide::both:
        front.push_back(add(front_part_, fragment.source));
        back.push_back(id);
        replace(id, back_part_);
    }
  }

  std::uint32_t add(const std::vector<BspCorner>& corners, std::uint32_t source) {
    if (fragments_.size() >= config_.most_fragments)
      throw std::length_error("the BSP tree needs more than " + std::to_string(config_.most_fragments) +
                              " fragments for " + std::to_string(bsp_.polygons.size()) + " polygons");
    fragments_.push_back(
        {static_cast<std::uint32_t>(corners_.size()), static_cast<std::uint32_t>(corners.size()), source, true});
    corners_.insert(corners_.end(), corners.begin(), corners.end());
    return static_cast<std::uint32_t>(fragments_.size() - 1);
  }

  /// In its old place if it fits.
  void replace(std::uint32_t id, const std::vector<BspCorner>& corners) {
    BspFragment& fragment = fragments_[id];
    if (corners.size() > fragment.count) {
      fragment.first = static_cast<std::uint32_t>(corners_.size());
      corners_.resize(corners_.size() + corners.size());
    }
    fragment.count = static_cast<std::uint32_t>(corners.size());
    std::copy(corners.begin(), corners.end(), corners_.begin() + fragment.first);
  }

  /// Puts the coplanar fragments into the finished tree and says what the leaves beside their plane are: the largest
  /// of them bounds both, if they are leaves.
  void place(List& on, std::uint32_t index) {
    std::stable_sort(on.begin(), on.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return fragments_[a].source < fragments_[b].source; });
    BspNode& node = bsp_.nodes[index];
    node.first = static_cast<std::uint32_t>(bsp_.fragments.size());
    node.count = static_cast<std::uint32_t>(on.size());
    double largest = -1.0;
    bool along = true;
    for (const std::uint32_t id : on) {
      BspFragment fragment = fragments_[id];
      const std::span<const BspCorner> corners = std::span(corners_).subspan(fragment.first, fragment.count);
      fragment.along = glm::dot(bsp_.planes[fragment.source].normal, node.plane.normal) > 0.0;
      fragment.first = static_cast<std::uint32_t>(bsp_.corners.size());
      bsp_.corners.insert(bsp_.corners.end(), corners.begin(), corners.end());
      bsp_.fragments.push_back(fragment);
      const double area = area_of(corners);
      if (area > largest) {
        largest = area;
        along = fragment.along;
      }
    }
    node.front = along ? bsp_outside : bsp_inside;
    node.back = along ? bsp_inside : bsp_outside;
  }

  static double area_of(std::span<const BspCorner> corners) {
    glm::dvec3 sum(0.0);
    for (std::size_t i = 2; i < corners.size(); ++i)
      sum += glm::cross(corners[i - 1].position - corners[0].position, corners[i].position - corners[0].position);
    return glm::length(sum);
  }

  Choice choose(const List& list, std::uint32_t node) {
    if (config_.splitter == BspSplitter::first || list.size() == 1) return of_polygon(list[0]);
    std::uint64_t state = scramble(config_.seed ^ scramble(node));
    const auto draw = [&] {
      state = scramble(state);
      return list[static_cast<std::size_t>(state % list.size())];
    };
    if (config_.splitter == BspSplitter::random) return of_polygon(draw());
    take_sample(list);
    if (config_.splitter == BspSplitter::pca && list.size() > config_.free_planes_above) {
      const Choice choice{pca_plane(), Choice::no_owner};
      if (parts_well(score(choice))) return choice;
    }
    Choice best;
    double best_cost = std::numeric_limits<double>::infinity();
    const auto tries = std::min(list.size(), static_cast<std::size_t>(config_.candidates));
    for (std::size_t i = 0; i < tries; ++i) {
      const Choice choice = of_polygon(tries == list.size() ? list[i] : draw());
      const double c = cost(score(choice));
      if (c < best_cost) {
        best_cost = c;
        best = choice;
      }
    }
    const bool free_planes = config_.splitter == BspSplitter::mixed || config_.splitter == BspSplitter::pca;
    if (free_planes && list.size() > config_.free_planes_above)
      for (int axis = 0; axis < 3; ++axis) {
        const Choice choice{median_plane(axis), Choice::no_owner};
        const Score s = score(choice);
        if (!parts_well(s) || !(cost(s) < best_cost)) continue;
        best_cost = cost(s);
        best = choice;
      }
    return best;
  }

  [[nodiscard]] Choice of_polygon(std::uint32_t id) const { return {bsp_.planes[fragments_[id].source], id}; }

  /// At most 256 fragments, evenly from the list, stand for all of them.
  void take_sample(const List& list) {
    constexpr std::size_t most = 256;
    sample_.clear();
    centres_.clear();
    const std::size_t count = std::min(list.size(), most);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t id = list[i * list.size() / count];
      sample_.push_back(id);
      const BspFragment& fragment = fragments_[id];
      glm::dvec3 sum(0.0);
      for (std::uint32_t k = 0; k < fragment.count; ++k) sum += corners_[fragment.first + k].position;
      centres_.push_back(sum / static_cast<double>(fragment.count));
    }
  }

  [[nodiscard]] Score score(const Choice& choice) const {
    Score result;
    for (const std::uint32_t id : sample_) {
      if (id == choice.owner) continue;
      const BspFragment& fragment = fragments_[id];
      bool front = false, back = false;
      for (std::uint32_t k = 0; k < fragment.count; ++k) {
        const double f = choice.plane.at(corners_[fragment.first + k].position);
        front |= f > bsp_.tolerance;
        back |= f < -bsp_.tolerance;
      }
      if (front && back) ++result.splits;
      if (front) ++result.front;
      if (back) ++result.back;
      if (!front && !back) ++result.on;
    }
    return result;
  }

  /// A plane without a polygon must bring the end nearer.
  [[nodiscard]] bool parts_well(const Score& s) const {
    return s.front > 0 && s.back > 0 && 10 * std::max(s.front, s.back) <= 8 * sample_.size();
  }

  [[nodiscard]] double cost(const Score& s) const {
    const auto splits = static_cast<double>(s.splits);
    const double imbalance = std::abs(static_cast<double>(s.front) - static_cast<double>(s.back));
    switch (config_.splitter) {
      case BspSplitter::fewest_splits:
        return splits + 1e-3 * imbalance;
      case BspSplitter::balance:
        return imbalance + 1e-3 * splits;
      default:
        return config_.split_weight * splits + imbalance;
    }
  }

  [[nodiscard]] BspPlane pca_plane() const {
    const PrincipalAxes axes = principal_axes(centres_);
    return {axes.axes[0], -glm::dot(axes.axes[0], axes.mean)};
  }

  /// Across an axis, half-way between the two middle centres, so that it does not run along a wall.
  [[nodiscard]] BspPlane median_plane(int axis) {
    values_.clear();
    for (const glm::dvec3& c : centres_) values_.push_back(c[axis]);
    const auto middle = values_.begin() + static_cast<std::ptrdiff_t>(values_.size() / 2);
    std::nth_element(values_.begin(), middle, values_.end());
    const double above = *middle, below = *std::max_element(values_.begin(), middle);
    BspPlane plane;
    plane.normal[axis] = 1.0;
    plane.offset = -0.5 * (above + below);
    return plane;
  }

  const BspConfig config_;
  Bsp bsp_;
  std::vector<BspFragment> fragments_;  // at work
  std::vector<BspCorner> corners_;      // of those; holes where fragments grew
  std::vector<Task> tasks_;
  double done_ = 0.0;
  std::vector<std::uint32_t> sample_;
  std::vector<glm::dvec3> centres_;
  std::vector<double> values_;
  std::vector<BspCorner> front_part_, back_part_;
};

}  // namespace

bool read_splitter(std::string_view name, BspSplitter& splitter) {
  constexpr std::array<std::pair<std::string_view, BspSplitter>, 6> names{
      {{"first", BspSplitter::first},
       {"random", BspSplitter::random},
       {"fewest_splits", BspSplitter::fewest_splits},
       {"balance", BspSplitter::balance},
       {"mixed", BspSplitter::mixed},
       {"pca", BspSplitter::pca}}};
  const auto found = std::find_if(names.begin(), names.end(), [&](const auto& n) { return n.first == name; });
  if (found == names.end()) return false;
  splitter = found->second;
  return true;
}

Bsp build_bsp(PolygonSet polygons, const BspConfig& config) { return Builder(std::move(polygons), config).build(); }

}  // namespace sightline
