#include "gl/multiquery.hpp"

#include <algorithm>
#include <cmath>

namespace sightline::gl {
namespace {

/// The sums over a prefix that both forms are made of.
struct Prefix {
  double all_stay = 1.0, triangles = 0.0;
  std::size_t count = 0;

  void add(const MultiqueryCandidate& candidate) {
    all_stay *= candidate.keep;
    triangles += candidate.triangles;
    ++count;
  }
  [[nodiscard]] double value(const MultiqueryConfig& config) const {
    const auto n = static_cast<double>(count);
    if (config.form == ValueForm::slides) return all_stay * triangles / (1.0 + config.c1 * n);
    return count == 1 ? 1.0 : n / (1.0 + (1.0 - all_stay) * n);  // a single node is never asked twice
  }
};

}  // namespace

double keep_probability(std::uint32_t hidden_frames) {
  return 0.99 - 0.7 * std::exp(-static_cast<double>(hidden_frames));
}

double multiquery_value(std::span<const MultiqueryCandidate> candidates, std::size_t n,
                        const MultiqueryConfig& config) {
  Prefix prefix;
  for (const MultiqueryCandidate& candidate : candidates.first(n)) prefix.add(candidate);
  return prefix.value(config);
}

std::size_t multiquery_size(std::span<const MultiqueryCandidate> candidates, const MultiqueryConfig& config) {
  Prefix prefix;
  double best = 0.0;
  std::size_t size = 1;
  const std::size_t most = std::min(candidates.size(), config.largest);
  for (std::size_t n = 1; n <= most; ++n) {
    prefix.add(candidates[n - 1]);
    const double value = prefix.value(config);
    if (value > best || n == 1) {
      best = value;
      size = n;
    } else if (config.form == ValueForm::paper) {
      break;
    }
  }
  return size;
}

}  // namespace sightline::gl
