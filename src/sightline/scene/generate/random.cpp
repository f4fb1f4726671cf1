#include "sightline/scene/generate/random.hpp"

#include <cmath>

namespace sightline {
namespace {

std::uint64_t scramble(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

// Taylor series on [0, pi / 4]: the first term left out is below 1e-17.
double sine_series(double x) {
  const double s = x * x;
  double sum = 0.0;
  for (int k = 17; k >= 3; k -= 2) sum = (1.0 + sum) * (-s / (k * (k - 1)));
  return x * (1.0 + sum);
}

double cosine_series(double x) {
  const double s = x * x;
  double sum = 0.0;
  for (int k = 18; k >= 2; k -= 2) sum = (1.0 + sum) * (-s / (k * (k - 1)));
  return 1.0 + sum;
}

}  // namespace

std::uint64_t mix(std::uint64_t a, std::uint64_t b) {
  return scramble(scramble(a + 0x9E3779B97F4A7C15u) ^ (b * 0xD1342543DE82EF95u + 0x2545F4914F6CDD1Du));
}

Random::Random(std::uint64_t seed, std::uint64_t stream) : state_(mix(seed, stream)) {}

std::uint64_t Random::next() {
  state_ += 0x9E3779B97F4A7C15u;
  return scramble(state_);
}

double Random::uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }

double Random::range(double low, double high) { return low + (high - low) * uniform(); }

double Random::middling(double low, double high) {
  const double a = uniform(), b = uniform(), c = uniform();
  return low + (high - low) * ((a + b + c) / 3.0);
}

std::uint32_t Random::below(std::uint32_t count) { return static_cast<std::uint32_t>(((next() >> 32) * count) >> 32); }

double Random::power_of_two_range(int low, int high) {
  const int exponent = low + static_cast<int>(below(static_cast<std::uint32_t>(high - low)));
  return std::ldexp(1.0 + uniform(), exponent);
}

glm::dvec3 Random::direction() {
  const double y = range(-1.0, 1.0);
  const glm::dvec2 around = circle_point(uniform());
  const double radius = std::sqrt(1.0 - y * y);
  return {around.x * radius, y, around.y * radius};
}

glm::dvec2 circle_point(double turns) {
  const double whole = turns - std::floor(turns);  // [0, 1]
  const int octant = static_cast<int>(whole * 8.0) & 7;
  const double rest = whole * 8.0 - std::floor(whole * 8.0);  // position within the octant
  const bool odd = (octant & 1) != 0;
  const double angle = (odd ? 1.0 - rest : rest) * 0.78539816339744830962;
  double c = cosine_series(angle), s = sine_series(angle);
  if (odd) std::swap(c, s);
  switch (octant >> 1) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    default:
      return {s, -c};
  }
}

}  // namespace sightline
