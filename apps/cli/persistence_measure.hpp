// Visibility persistence: how likely what was hidden for t frames stays hidden (checklist 23.02-23.05), measured, and
// the curve a - b e^-ct through it.
#pragma once

#include <cstdint>
#include <vector>

#include "sightline/core/visible_set.hpp"

namespace sightline::cli {

/// Counts over the frames of a walk. An object takes part while it is in the frustum; one that leaves it is forgotten.
class Persistence {
 public:
  Persistence(std::size_t objects, int longest);
  /// The next frame: which objects are in the frustum, which of them are seen.
  void frame(const VisibleSet& in_frustum, const VisibleSet& seen);

  /// I(t), t = 1 .. longest: how often an object had been hidden for at least t frames without a break.
  [[nodiscard]] const std::vector<std::uint64_t>& hidden() const { return hidden_; }
  /// p(t), t = 1 .. longest: share of those hidden for exactly t frames, and still in the frustum in the next one, that
  /// are hidden there as well; negative where there are none.
  [[nodiscard]] std::vector<double> keep() const;
  /// The number of observations behind each p(t).
  [[nodiscard]] const std::vector<std::uint64_t>& observed() const { return observed_; }

 private:
  std::vector<std::uint32_t> run_;  // frames for which an object has been hidden
  std::vector<std::uint64_t> hidden_, observed_, kept_;
};

/// p(t) = a - b e^(-c t).
struct PersistenceFit {
  double a = 0.0, b = 0.0, c = 0.0;
  double error = 0.0;  // weighted root mean square
  bool valid = false;  // false with fewer than three points
  [[nodiscard]] double at(double t) const;
};

/// Weighted least squares over t = 1, 2, ...; points with a negative value or weight 0 do not count.
PersistenceFit fit_persistence(const std::vector<double>& keep, const std::vector<std::uint64_t>& weights);

}  // namespace sightline::cli
