// Small charts as SVG: lines over a number, and bars over names. Self-contained files, readable on white.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace sightline::cli {

struct Series {
  std::string name;
  std::vector<std::pair<double, double>> points;
};

/// The axes start at zero. `log_x`: powers of two along x.
std::string line_chart(const std::string& title, const std::string& x, const std::string& y,
                       const std::vector<Series>& series, bool log_x = false);

std::string bar_chart(const std::string& title, const std::string& y,
                      const std::vector<std::pair<std::string, double>>& bars);

}  // namespace sightline::cli
