// The occlusion horizon of a 2.5-D city (Wonka and Schmalstieg 1999; Downs, Moller, Sequin 2001; checklist 21.03), made
// safe for any scene: over columns of plan directions, from which to which slope everything is hidden by walls drawn so
// far. Columns do not tilt with the camera. Front to back: ask about all that lies nearer before a wall is added.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/raster/horizon_kernels.hpp"
#include "sightline/raster/wall_fences.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

class Horizon {
 public:
  /// Starts a view with nothing hidden; at most `columns` columns (up to 65535) over what the view can see. False if
  /// the view looks so steeply that it has no horizon; then nothing may be added or asked.
  bool begin(const View& view, int columns);

  /// What boxes are asked against; good until the next begin().
  [[nodiscard]] const HorizonPlan& plan() const { return plan_; }

  /// Adds a fence moved by `offset`. Rectangles that reach before the near plane or behind the eye are left out.
  /// `slack`: metres by which the real walls may differ.
  void add(const WallFence& fence, const glm::dvec3& offset, double slack);

  [[nodiscard]] int columns() const { return plan_.columns; }
  /// The hidden interval of slopes of a column; empty (low > high) where nothing is hidden.
  [[nodiscard]] float low(int column) const { return low_[static_cast<std::size_t>(column)]; }
  [[nodiscard]] float high(int column) const { return high_[static_cast<std::size_t>(column)]; }
  /// The coordinate of the left border of a column.
  [[nodiscard]] double border(int column) const { return column / plan_.per_u - plan_.limit; }

 private:
  HorizonPlan plan_;
  std::vector<float> low_, high_;  // by column, padded by 8
  std::vector<double> scratch_;
};

}  // namespace sightline
