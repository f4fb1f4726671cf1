// Curves as a picture: a small SVG, for plots that verbs write beside their numbers.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace sightline::cli {

struct PlotCurve {
  std::string name;
  std::vector<std::pair<double, double>> points;
  bool dots = false;  // a dot at each point instead of a line through them
};

struct LinePlot {
  std::string title, x, y;           // y and x: what the axes show
  bool log_x = false;                // base 2
  double y_low = 0.0, y_high = 0.0;  // both 0: from the points, from 0 on
  std::vector<PlotCurve> curves;
};

/// A scene as a title shows it: without its folders.
std::string title_of(const std::string& scene);

/// The bytes of an SVG file, 720 x 440.
std::string svg_of(const LinePlot& plot);

}  // namespace sightline::cli
