// The scene of a walk with its index and its truth, and what moves in it from frame to frame.
#pragma once

#include <cstdint>
#include <optional>

#include "sightline/core/algorithm.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/scene/generate/motion.hpp"

namespace sightline::cli {

class WalkScene {
 public:
  /// The scene must outlive it. `moving`: the share of its objects that move, 0 to 1. `truth`: whether oracle() will be
  /// asked.
  WalkScene(Scene& scene, double moving, std::uint64_t seed, bool truth);

  [[nodiscard]] const IndexedScene& indexed() const { return indexed_; }
  [[nodiscard]] const Oracle& oracle() const { return *oracle_; }
  /// How many objects move.
  [[nodiscard]] std::size_t moving() const { return motion_.count(); }

  /// Puts the objects where they are in a frame, counted from 0; index and truth follow. Returns the milliseconds that
  /// moving and refitting took, without those of the truth.
  double to_frame(std::size_t frame);

 private:
  Scene& scene_;
  Motion motion_;
  std::size_t frame_ = 0;
  IndexedScene indexed_;
  std::optional<Oracle> oracle_;
};

}  // namespace sightline::cli
