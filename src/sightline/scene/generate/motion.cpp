#include "sightline/scene/generate/motion.hpp"

#include <cmath>

#include "sightline/scene/generate/random.hpp"

namespace sightline {

Motion::Motion(const Scene& scene, double share, std::uint64_t seed) {
  Random random(seed);
  const double size = glm::length(glm::dvec3(scene.bounds().extent()));
  for (ObjectId id = 0; id < scene.objects().size(); ++id) {
    const Object& object = scene.objects()[id];
    const bool moves = random.chance(share);
    const glm::dvec2 centre = size * random.range(1.0 / 400, 1.0 / 40) * circle_point(random.uniform());
    const double turns = (random.chance(0.5) ? 1 : -1) / random.range(60, 240);
    if (moves && !object.bounds.empty())
      rounds_.push_back({id, object.transform, glm::dvec3(object.bounds.centre()), centre, turns});
  }
}

std::vector<Scene::Move> Motion::at(std::size_t frame) const {
  std::vector<Scene::Move> moves;
  moves.reserve(rounds_.size());
  for (const Round& round : rounds_) {
    const double turns = round.turns * static_cast<double>(frame);
    const glm::dvec2 turn = circle_point(turns - std::floor(turns));
    // About the upright axis through the centre of the circle.
    const glm::dvec3 axis = round.pivot + glm::dvec3(round.centre.x, 0, round.centre.y);
    const auto turned = [&](const glm::dvec3& v) {
      return glm::dvec3(turn.x * v.x - turn.y * v.z, v.y, turn.y * v.x + turn.x * v.z);
    };
    Affine transform;
    for (int i = 0; i < 3; ++i) transform[i] = glm::vec3(turned(glm::dvec3(round.start[i])));
    transform[3] = glm::vec3(axis + turned(glm::dvec3(round.start[3]) - axis));
    moves.push_back({round.object, frame == 0 ? round.start : transform});
  }
  return moves;
}

}  // namespace sightline
