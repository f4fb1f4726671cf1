// Seeded numbers that are the same on every machine and compiler: SplitMix64 (Steele, Lea and Flood 2014) and
// arithmetic that IEEE 754 fixes bit by bit. The distributions and the sine of the standard library promise neither.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace sightline {

class Random {
 public:
  /// Streams of one seed are independent: a part of a scene keeps its shape when another part draws more numbers.
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0);

  std::uint64_t next();
  /// In [0, 1), 53 bits.
  double uniform();
  /// In [low, high).
  double range(double low, double high);
  /// Sum of three uniforms: bell-shaped in [low, high).
  double middling(double low, double high);
  /// In 0 .. count - 1; count > 0.
  std::uint32_t below(std::uint32_t count);
  bool chance(double probability) { return uniform() < probability; }
  /// In [2^low, 2^high), about evenly many in every power of two; low < high.
  double power_of_two_range(int low, int high);
  /// Evenly on the unit sphere.
  glm::dvec3 direction();

 private:
  std::uint64_t state_;
};

/// Mixes two numbers into a seed.
std::uint64_t mix(std::uint64_t a, std::uint64_t b);

/// Cosine and sine of an angle in full turns, |turns| < 2^40; within 1e-14, exact at multiples of a quarter.
glm::dvec2 circle_point(double turns);

}  // namespace sightline
