// Which hidden nodes share one query (Mattausch, Bittner and Wimmer 2008; checklist 23.02-23.09, E48): nodes that were
// hidden for long are likely to stay so, and one answer "hidden" settles them all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace sightline::gl {

/// Probability that what was hidden for t frames stays hidden in the next: 0.99 - 0.7 e^-t. p(0) = 0.29.
double keep_probability(std::uint32_t hidden_frames);

enum class ValueForm {
  paper,  // benefit |M|, cost 1 + p_fail(M) |M|; nodes are added until the value falls
  slides  // benefit i(M) * sum of triangles, cost 1 + c1 |M|; the best of all prefixes
};

struct MultiqueryCandidate {
  double keep = 0.0;       // keep_probability
  double triangles = 0.0;  // below the node
};

struct MultiqueryConfig {
  ValueForm form = ValueForm::paper;
  double c1 = 0.1;            // slides: cost of a node in a query relative to that of the query, >= 0
  std::size_t largest = 256;  // nodes in a query, >= 1
};

/// Value of a query for the first n candidates.
double multiquery_value(std::span<const MultiqueryCandidate> candidates, std::size_t n, const MultiqueryConfig& config);

/// How many of the candidates, which are sorted by falling `keep`, the next query takes: at least 1. O(n).
std::size_t multiquery_size(std::span<const MultiqueryCandidate> candidates, const MultiqueryConfig& config);

}  // namespace sightline::gl
