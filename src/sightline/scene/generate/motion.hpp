// Objects on the move, for scenes whose files let everything stand still: each of a chosen share drives round a level
// circle through its place and turns with it, smoothly, for ever. Same seed, same motion on every machine.
#pragma once

#include <cstdint>
#include <vector>

#include "sightline/scene/scene.hpp"

namespace sightline {

class Motion {
 public:
  /// Every object that has triangles moves with the probability `share`, 0 to 1. The circles are between 1/200 and 1/20
  /// of the scene's size across, and take 60 to 240 frames.
  Motion(const Scene& scene, double share, std::uint64_t seed);

  /// How many objects move.
  [[nodiscard]] std::size_t count() const { return rounds_.size(); }
  /// Where they are in a frame, counted from 0, in which everything is where it was.
  [[nodiscard]] std::vector<Scene::Move> at(std::size_t frame) const;

 private:
  struct Round {
    ObjectId object;
    Affine start;
    glm::dvec3 pivot;   // the centre of the object's bounds at the start
    glm::dvec2 centre;  // of the circle, seen from the pivot; x and z, metres
    double turns;       // for each frame; below 0: the other way round
  };
  std::vector<Round> rounds_;
};

}  // namespace sightline
