#include "plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sightline::cli {
namespace {

constexpr double width = 640, height = 400, left = 64, right = 16, top = 40, bottom = 56;
constexpr const char* colours[] = {"#1b6ca8", "#c8553d", "#3a7d44", "#8e5ea2", "#b08900"};

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

std::string text_at(double x, double y, const std::string& text, const char* anchor, const char* more = "") {
  return fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}'{}>{}</text>\n", x, y, anchor, more, escaped(text));
}

/// A round number that divides `largest` into about five steps.
double step_for(double largest) {
  const double rough = largest / 5, power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (rough <= factor * power) return factor * power;
  return 10 * power;
}

std::string frame_of(const std::string& title, const std::string& y_label, double largest) {
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0} {1}' font-family='sans-serif' font-size='12'>\n"
      "<rect width='{0}' height='{1}' fill='white'/>\n",
      width, height);
  svg += text_at(width / 2, 20, title, "middle", " font-size='14' font-weight='bold'");
  svg += text_at(16, top + (height - top - bottom) / 2, y_label, "middle",
                 fmt::format(" transform='rotate(-90 16 {})'", top + (height - top - bottom) / 2).c_str());
  const double step = step_for(largest);
  for (double v = 0; v <= largest * 1.0001; v += step) {
    const double y = height - bottom - v / largest * (height - top - bottom);
    svg += fmt::format("<line x1='{}' x2='{}' y1='{:.1f}' y2='{:.1f}' stroke='#ddd'/>\n", left, width - right, y, y);
    svg += text_at(left - 6, y + 4, fmt::format("{:g}", v), "end");
  }
  return svg;
}

}  // namespace

std::string line_chart(const std::string& title, const std::string& x_label, const std::string& y_label,
                       const std::vector<Series>& series, bool log_x) {
  double most_x = 0, most_y = 0;
  const auto along = [&](double x) { return log_x ? std::log2(std::max(x, 1.0)) : x; };
  for (const Series& s : series)
    for (const auto& [x, y] : s.points) {
      most_x = std::max(most_x, along(x));
      most_y = std::max(most_y, y);
    }
  most_x = most_x > 0 ? most_x : 1;
  most_y = most_y > 0 ? most_y : 1;
  const auto place_x = [&](double x) { return left + along(x) / most_x * (width - left - right); };
  const auto place_y = [&](double y) { return height - bottom - y / most_y * (height - top - bottom); };
  std::string svg = frame_of(title, y_label, most_y);
  if (!series.empty())
    for (const auto& [x, y] : series.front().points)
      svg += text_at(place_x(x), height - bottom + 16, fmt::format("{:g}", x), "middle");
  svg += text_at(left + (width - left - right) / 2, height - 14, x_label, "middle");
  for (std::size_t i = 0; i < series.size(); ++i) {
    std::string path;
    for (const auto& [x, y] : series[i].points)
      path += fmt::format("{}{:.1f} {:.1f} ", path.empty() ? "M" : "L", place_x(x), place_y(y));
    svg += fmt::format("<path d='{}' fill='none' stroke='{}' stroke-width='2'{}/>\n", path, colours[i % 5],
                       i > 0 ? " stroke-dasharray='6 3'" : "");
    svg += fmt::format("<rect x='{}' y='{}' width='14' height='4' fill='{}'/>\n", left + 12,
                       top + 6 + 18 * static_cast<double>(i), colours[i % 5]);
    svg += text_at(left + 32, top + 12 + 18 * static_cast<double>(i), series[i].name, "start");
  }
  return svg + "</svg>\n";
}

std::string bar_chart(const std::string& title, const std::string& y_label,
                      const std::vector<std::pair<std::string, double>>& bars) {
  double most = 0;
  for (const auto& bar : bars) most = std::max(most, bar.second);
  most = most > 0 ? most : 1;
  std::string svg = frame_of(title, y_label, most);
  const double room = (width - left - right) / static_cast<double>(std::max<std::size_t>(bars.size(), 1));
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const double tall = bars[i].second / most * (height - top - bottom), x = left + room * static_cast<double>(i);
    svg += fmt::format("<rect x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}' fill='{}'/>\n", x + 0.12 * room,
                       height - bottom - tall, 0.76 * room, tall, colours[0]);
    svg += text_at(x + room / 2, height - bottom - tall - 4, fmt::format("{:.4g}", bars[i].second), "middle",
                   " font-size='10'");
    svg += text_at(x + room / 2, height - bottom + 16, bars[i].first, "middle", " font-size='10'");
  }
  return svg + "</svg>\n";
}

}  // namespace sightline::cli
