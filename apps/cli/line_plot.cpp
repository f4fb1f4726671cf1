#include "line_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

namespace sightline::cli {
namespace {

/// The picture and its margins in pixels.
constexpr struct {
  double width = 720, height = 440, left = 70, right = 20, top = 40, bottom = 50;
} sheet;
constexpr std::array colours{"#1f6fb4", "#d1495b", "#2e933c", "#8d6a9f", "#e58c2f", "#444444"};

struct Scale {
  double x0, x1, y0, y1;
  bool log_x;
  [[nodiscard]] double x(double v) const {
    const double a = log_x ? std::log2(x0) : x0, b = log_x ? std::log2(x1) : x1, w = log_x ? std::log2(v) : v;
    return sheet.left + (sheet.width - sheet.left - sheet.right) * (w - a) / std::max(b - a, 1e-30);
  }
  [[nodiscard]] double y(double v) const {
    return sheet.height - sheet.bottom -
           (sheet.height - sheet.top - sheet.bottom) * (v - y0) / std::max(y1 - y0, 1e-30);
  }
};

Scale scale_of(const LinePlot& plot) {
  Scale scale{1e300, -1e300, plot.y_low, plot.y_high, plot.log_x};
  double highest = 0.0;
  for (const PlotCurve& curve : plot.curves)
    for (const auto& [x, y] : curve.points) {
      scale.x0 = std::min(scale.x0, x);
      scale.x1 = std::max(scale.x1, x);
      highest = std::max(highest, y);
    }
  if (scale.x0 > scale.x1) scale.x0 = 1.0, scale.x1 = 1.0;
  if (scale.x0 == scale.x1) scale.x1 = scale.x0 + 1.0;
  if (plot.y_low == 0.0 && plot.y_high == 0.0) scale.y1 = highest > 0.0 ? 1.05 * highest : 1.0;
  return scale;
}

/// 1, 2 or 5 times a power of ten, about a fifth of the range.
double step_of(double range) {
  const double raw = range / 5.0, power = std::pow(10.0, std::floor(std::log10(std::max(raw, 1e-30))));
  for (const double factor : {1.0, 2.0, 5.0})
    if (raw <= factor * power) return factor * power;
  return 10.0 * power;
}

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  return safe;
}

std::string axes(const LinePlot& plot, const Scale& scale) {
  std::string svg;
  const auto label = [&](double x, double y, const char* anchor, const std::string& text) {
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, escaped(text));
  };
  const auto grid = [&](double x0, double y0, double x1, double y1) {
    svg += fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"#ddd\"/>\n", x0, y0, x1, y1);
  };
  const double y_step = step_of(scale.y1 - scale.y0);
  for (double v = std::ceil(scale.y0 / y_step - 1e-9) * y_step; v <= scale.y1 + 1e-9 * y_step; v += y_step) {
    grid(sheet.left, scale.y(v), sheet.width - sheet.right, scale.y(v));
    label(sheet.left - 6, scale.y(v) + 4, "end", fmt::format("{:.6g}", std::abs(v) < 1e-12 ? 0.0 : v));
  }
  if (plot.log_x) {
    for (double v = std::exp2(std::ceil(std::log2(scale.x0))); v <= scale.x1 * 1.001; v *= 2) {
      grid(scale.x(v), sheet.top, scale.x(v), sheet.height - sheet.bottom);
      label(scale.x(v), sheet.height - sheet.bottom + 18, "middle", fmt::format("{:.6g}", v));
    }
  } else {
    const double x_step = step_of(scale.x1 - scale.x0);
    for (double v = std::ceil(scale.x0 / x_step - 1e-9) * x_step; v <= scale.x1 + 1e-9 * x_step; v += x_step) {
      grid(scale.x(v), sheet.top, scale.x(v), sheet.height - sheet.bottom);
      label(scale.x(v), sheet.height - sheet.bottom + 18, "middle",
            fmt::format("{:.6g}", std::abs(v) < 1e-12 ? 0.0 : v));
    }
  }
  label(sheet.width / 2, sheet.height - 10, "middle", plot.x);
  label(sheet.width / 2, 22, "middle", plot.title);
  svg += fmt::format("<text transform=\"translate(18 {:.0f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                     sheet.height / 2, escaped(plot.y));
  return svg;
}

}  // namespace

std::string title_of(const std::string& scene) { return std::filesystem::path(scene).filename().string(); }

std::string svg_of(const LinePlot& plot) {
  const Scale scale = scale_of(plot);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      sheet.width, sheet.height);
  svg += axes(plot, scale);
  for (std::size_t c = 0; c < plot.curves.size(); ++c) {
    const PlotCurve& curve = plot.curves[c];
    const char* colour = colours[c % colours.size()];
    std::string path;
    for (const auto& [x, y] : curve.points) {
      const double at = std::clamp(scale.y(y), sheet.top, sheet.height - sheet.bottom);
      if (curve.dots)
        svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", scale.x(x), at, colour);
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', scale.x(x), at);
    }
    if (!curve.dots && !path.empty())
      svg += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>\n", path, colour);
    svg += fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"end\" fill=\"{}\">{}</text>\n",
                       sheet.width - sheet.right - 8,
                       sheet.height - sheet.bottom - 14.0 - 18.0 * static_cast<double>(c), colour, escaped(curve.name));
  }
  return svg + "</svg>\n";
}

}  // namespace sightline::cli
