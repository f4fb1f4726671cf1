#include "persistence_measure.hpp"

#include <algorithm>
#include <cmath>

namespace sightline::cli {

Persistence::Persistence(std::size_t objects, int longest)
    : run_(objects),
      hidden_(static_cast<std::size_t>(longest)),
      observed_(static_cast<std::size_t>(longest)),
      kept_(static_cast<std::size_t>(longest)) {}

void Persistence::frame(const VisibleSet& in_frustum, const VisibleSet& seen) {
  for (std::size_t i = 0; i < run_.size(); ++i) {
    const auto id = static_cast<ObjectId>(i);
    const bool inside = in_frustum.contains(id), hidden = inside && !seen.contains(id);
    const std::uint32_t before = run_[i];
    if (inside && before > 0 && before <= observed_.size()) {
      ++observed_[before - 1];
      kept_[before - 1] += hidden ? 1 : 0;
    }
    run_[i] = hidden ? before + 1 : 0;
    const std::size_t reached = std::min<std::size_t>(run_[i], hidden_.size());
    for (std::size_t t = 0; t < reached; ++t) ++hidden_[t];
  }
}

std::vector<double> Persistence::keep() const {
  std::vector<double> p(observed_.size(), -1.0);
  for (std::size_t t = 0; t < p.size(); ++t)
    if (observed_[t] > 0) p[t] = static_cast<double>(kept_[t]) / static_cast<double>(observed_[t]);
  return p;
}

double PersistenceFit::at(double t) const { return a - b * std::exp(-c * t); }

namespace {

/// For one c the best a and b follow from a 2 x 2 system.
PersistenceFit fit_for(double c, const std::vector<double>& keep, const std::vector<std::uint64_t>& weights) {
  double s = 0, se = 0, see = 0, sp = 0, spe = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (keep[i] < 0.0 || weights[i] == 0) continue;
    const double w = static_cast<double>(weights[i]), e = std::exp(-c * static_cast<double>(i + 1));
    s += w;
    se += w * e;
    see += w * e * e;
    sp += w * keep[i];
    spe += w * keep[i] * e;
  }
  PersistenceFit fit;
  fit.c = c;
  const double determinant = s * see - se * se;
  if (s <= 0.0 || std::abs(determinant) < 1e-12 * s * see) return fit;
  fit.a = (sp * see - spe * se) / determinant;
  fit.b = (sp * se - spe * s) / determinant;
  double squares = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (keep[i] < 0.0 || weights[i] == 0) continue;
    const double miss = fit.at(static_cast<double>(i + 1)) - keep[i];
    squares += static_cast<double>(weights[i]) * miss * miss;
  }
  fit.error = std::sqrt(squares / s);
  fit.valid = true;
  return fit;
}

}  // namespace

PersistenceFit fit_persistence(const std::vector<double>& keep, const std::vector<std::uint64_t>& weights) {
  std::size_t points = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) points += keep[i] >= 0.0 && weights[i] > 0 ? 1 : 0;
  PersistenceFit best;
  if (points < 3) return best;
  // The error has one valley over log c: a grid finds it, a ternary search its bottom.
  double low = std::log(1e-3), high = std::log(10.0), at = low;
  for (int i = 0; i <= 200; ++i) {
    const double c = low + (high - low) * i / 200.0;
    const PersistenceFit fit = fit_for(std::exp(c), keep, weights);
    if (fit.valid && (!best.valid || fit.error < best.error)) {
      best = fit;
      at = c;
    }
  }
  const double step = (high - low) / 200.0;
  low = at - step;
  high = at + step;
  for (int i = 0; i < 60; ++i) {
    const double x = low + (high - low) / 3, y = high - (high - low) / 3;
    if (fit_for(std::exp(x), keep, weights).error <= fit_for(std::exp(y), keep, weights).error)
      high = y;
    else
      low = x;
  }
  const PersistenceFit fine = fit_for(std::exp(0.5 * (low + high)), keep, weights);
  return fine.valid && fine.error <= best.error ? fine : best;
}

}  // namespace sightline::cli
