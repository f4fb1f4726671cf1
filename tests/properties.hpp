// Generators of random geometry for property tests: finite values of every magnitude that a scene may hold.
#pragma once

#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "sightline/geometry/aabb.hpp"

namespace sightline::properties {

/// A number in [low, high), on a grid of a million steps.
inline double number(double low, double high) {
  return low + (high - low) * 1e-6 * static_cast<double>(*rc::gen::inRange(0, 1000000));
}

inline glm::dvec3 point(double reach) { return {number(-reach, reach), number(-reach, reach), number(-reach, reach)}; }

/// A unit vector; every direction can come, the axes among them.
inline glm::dvec3 direction() {
  const glm::dvec3 v(*rc::gen::inRange(-100, 101), *rc::gen::inRange(-100, 101), *rc::gen::inRange(-100, 101));
  return v == glm::dvec3(0.0) ? glm::dvec3(0, 0, -1) : glm::normalize(v);
}

inline glm::dquat rotation() { return glm::angleAxis(number(-3.2, 3.2), direction()); }

/// A box that is not empty; flat ones and points can come.
inline Aabb box(double reach, double size) {
  const glm::vec3 corner(point(reach));
  const glm::vec3 extent(glm::abs(point(size)));
  return {corner,
          corner + extent * glm::vec3(*rc::gen::inRange(0, 2), *rc::gen::inRange(0, 2), *rc::gen::inRange(0, 2))};
}

}  // namespace sightline::properties
