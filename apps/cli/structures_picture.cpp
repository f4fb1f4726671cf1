#include "structures_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "sightline/geometry/triangle_overlap.hpp"
#include "sightline/index/axis_tree.hpp"

namespace sightline::cli {
namespace {

constexpr double bar_height = 16, chart_width = 300, label_width = 120, chart_gap = 30;
constexpr std::array<const char*, 3> colours{"#d98c3f", "#4878a8", "#5a9a5a"};

std::string short_number(double v) {
  if (v >= 1e4) return fmt::format("{:.0f}", v);
  if (v >= 100) return fmt::format("{:.0f}", v);
  return fmt::format("{:.3g}", v);
}

std::string draw_chart(const Bars& chart, double x, double y) {
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (const double v : chart.values)
    if (std::isfinite(v) && v > 0.0) {
      least = std::min(least, v);
      most = std::max(most, v);
    }
  const bool logarithmic = most > 100.0 * least;
  const auto length = [&](double v) {
    if (!(v > 0.0) || !std::isfinite(v) || !(most > 0.0)) return 0.0;
    const double share = logarithmic ? (std::log(v / least) + 0.7) / (std::log(most / least) + 0.7) : v / most;
    return share * (chart_width - 60);
  };
  std::string svg = fmt::format("<text x='{}' y='{}' font-weight='bold'>{} [{}]{}</text>\n", x, y - 8, chart.title,
                                chart.unit, logarithmic ? ", logarithmic" : "");
  for (std::size_t i = 0; i < chart.values.size(); ++i) {
    const double at = y + static_cast<double>(i) * (bar_height + 4);
    if (!std::isfinite(chart.values[i])) {
      svg += fmt::format("<text x='{}' y='{}' fill='#888'>-</text>\n", x, at + 12);
      continue;
    }
    const double l = length(chart.values[i]);
    svg += fmt::format("<rect x='{}' y='{}' width='{:.1f}' height='{}' fill='#4878a8'/>", x, at, l, bar_height);
    svg += fmt::format("<text x='{:.1f}' y='{}'>{}</text>\n", x + l + 4, at + 12, short_number(chart.values[i]));
  }
  return svg;
}

std::string svg_head(double width, double height) {
  return fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0:.0f}' height='{1:.0f}' viewBox='0 0 {0:.0f} {1:.0f}' "
      "font-family='sans-serif' font-size='12'>\n<rect width='100%' height='100%' fill='white'/>\n",
      width, height);
}

/// The cells of one tree, and how deep it got.
struct Cells {
  struct Leaf {
    Aabb cell;
    std::set<std::uint32_t> objects;
  };
  std::vector<Leaf> leaves;
  int inner = 0, generations = 0;
};

/// Halves along both axes at once, or along one after the other, until a cell holds at most one object.
Cells subdivide(const TriangleSoup& soup, const Aabb& root, bool both, int limit) {
  struct Task {
    Aabb cell;
    int depth;
    std::vector<std::uint32_t> items;
  };
  Cells cells;
  std::vector<std::uint32_t> all(soup.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  std::vector<Task> stack{{root, 0, all}};
  while (!stack.empty()) {
    const Task task = stack.back();
    stack.pop_back();
    std::set<std::uint32_t> objects;
    for (const std::uint32_t i : task.items) objects.insert(soup.ids(i).object);
    cells.generations = std::max(cells.generations, task.depth);
    if (objects.size() <= 1 || task.depth == limit) {
      cells.leaves.push_back({task.cell, objects});
      continue;
    }
    ++cells.inner;
    const std::uint32_t axes = both ? 5u : task.depth % 2 == 0 ? 1u : 4u;
    for (std::uint32_t k = 0; k < (both ? 4u : 2u); ++k) {
      Task child{child_cell(task.cell, axes, k), task.depth + 1, {}};
      for (const std::uint32_t i : task.items)
        if (triangle_touches_box(soup.triangle(i), child.cell)) child.items.push_back(i);
      stack.push_back(std::move(child));
    }
  }
  return cells;
}

constexpr double side = 420;

std::string draw_tree(const TriangleSoup& soup, const Aabb& root, const Cells& cells, const std::string& title,
                      const std::string& letters, double left) {
  constexpr double top = 50;
  const double scale = side / static_cast<double>(root.extent().x);
  const auto x_of = [&](float x) { return left + scale * static_cast<double>(x - root.lo.x); };
  const auto y_of = [&](float z) { return top + scale * static_cast<double>(z - root.lo.z); };
  std::string svg = fmt::format("<text x='{}' y='20' font-size='16' font-weight='bold'>{}</text>\n", left, title);
  svg += fmt::format("<text x='{}' y='40'>{} generations, {} inner nodes, {} leaves</text>\n", left, cells.generations,
                     cells.inner, cells.leaves.size());
  for (std::uint32_t i = 0; i < soup.size(); ++i) {
    const glm::vec3* c = soup.triangle(i);
    const char* colour = colours[soup.ids(i).object % colours.size()];
    svg += fmt::format(
        "<path d='M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z' fill='{}' stroke='{}' stroke-width='0.5'/>\n",
        x_of(c[0].x), y_of(c[0].z), x_of(c[1].x), y_of(c[1].z), x_of(c[2].x), y_of(c[2].z), colour, colour);
  }
  for (const Cells::Leaf& leaf : cells.leaves) {
    const double x = x_of(leaf.cell.lo.x), y = y_of(leaf.cell.lo.z), w = x_of(leaf.cell.hi.x) - x,
                 h = y_of(leaf.cell.hi.z) - y;
    svg += fmt::format(
        "<rect x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}' fill='none' stroke='#333' stroke-width='{}'/>\n", x,
        y, w, h, letters.empty() ? 0.4 : 0.8);
    if (letters.empty()) continue;
    std::string label = leaf.objects.empty() ? "e" : "";
    for (const std::uint32_t id : leaf.objects) label += letters[id % letters.size()];
    const double size = std::clamp(0.45 * std::min(w, h), 7.0, 20.0);
    svg += fmt::format("<text x='{:.1f}' y='{:.1f}' font-size='{:.0f}' text-anchor='middle'>{}</text>\n", x + w / 2,
                       y + h / 2 + size / 3, size, label);
  }
  return svg;
}

void add_fan(TriangleSoup& soup, const std::vector<glm::vec2>& outline) {
  for (std::size_t i = 1; i + 1 < outline.size(); ++i)
    for (const glm::vec2& p : {outline[0], outline[i], outline[i + 1]}) soup.corners.emplace_back(p.x, 0.0f, p.y);
  if (soup.first.empty()) soup.first.push_back(0);
  soup.object.push_back(static_cast<std::uint32_t>(soup.object.size()));
  soup.first.push_back(static_cast<std::uint32_t>(soup.size()));
}

}  // namespace

std::string draw_bars(const std::vector<std::string>& names, const std::vector<Bars>& charts) {
  constexpr std::size_t per_row = 3;
  const double row_height = static_cast<double>(names.size()) * (bar_height + 4) + 60;
  const std::size_t rows = (charts.size() + per_row - 1) / per_row;
  const double width = label_width + per_row * (chart_width + chart_gap);
  std::string svg = svg_head(width, static_cast<double>(rows) * row_height + 10);
  for (std::size_t row = 0; row < rows; ++row) {
    const double y = static_cast<double>(row) * row_height + 40;
    for (std::size_t i = 0; i < names.size(); ++i)
      svg += fmt::format("<text x='{}' y='{}' text-anchor='end'>{}</text>\n", label_width - 8,
                         y + static_cast<double>(i) * (bar_height + 4) + 12, names[i]);
    for (std::size_t c = row * per_row; c < std::min(charts.size(), (row + 1) * per_row); ++c)
      svg += draw_chart(charts[c], label_width + static_cast<double>(c - row * per_row) * (chart_width + chart_gap), y);
  }
  return svg + "</svg>\n";
}

std::string draw_cells(const TriangleSoup& soup, int generations, const std::string& letters) {
  const Aabb bounds = bounds_of(soup);
  Aabb root = bounds;
  if (letters.empty() && !bounds.empty()) {  // a square around the scene
    const float half = 0.5f * std::max({bounds.extent().x, bounds.extent().z, 1e-6f});
    root.lo = {bounds.centre().x - half, bounds.lo.y, bounds.centre().z - half};
    root.hi = {bounds.centre().x + half, bounds.hi.y, bounds.centre().z + half};
  } else {
    root = {{0, 0, 0}, {16, 0, 16}};
  }
  const Cells quad = subdivide(soup, root, true, generations), kd = subdivide(soup, root, false, 2 * generations);
  std::string svg = svg_head(2 * side + 60, side + 70);
  svg += draw_tree(soup, root, quad, "Quadtree: both axes halved at once", letters, 20);
  svg += draw_tree(soup, root, kd, "kd-tree: one axis halved after the other", letters, side + 40);
  return svg + "</svg>\n";
}

std::string draw_octree(const TriangleSoup& soup) {
  constexpr double panel = 330;
  std::string svg = svg_head(3 * panel, panel + 50);
  for (int depth = 0; depth < 3; ++depth) {
    // A depth of 0 would mean "chosen by size".
    const AxisTree tree =
        build_axis_tree(soup, {.leaf_size = depth == 0 ? ~0u : 1u, .node_cost = 0.0f, .max_depth = std::max(depth, 1)});
    struct Filled {
      Aabb cell;
      double distance;
    };
    std::vector<Filled> cells;
    std::size_t nodes = 0;
    for_each_cell(tree, [&](const Aabb& cell, int, const AxisNode& node) {
      ++nodes;
      const glm::vec3 c = cell.centre();
      if (node.axes == 0 && node.count > 0) cells.push_back({cell, static_cast<double>(c.x + c.y + c.z)});
    });
    std::sort(cells.begin(), cells.end(), [](const Filled& a, const Filled& b) { return a.distance < b.distance; });
    const double left = depth * panel,
                 scale = 0.55 * panel / std::max(1e-6, static_cast<double>(tree.bounds.extent().x));
    const glm::vec3 middle = tree.bounds.centre();
    // Isometric, from +x +y +z.
    const auto point = [&](const glm::vec3& p) {
      const glm::dvec3 d(p - middle);
      return fmt::format("{:.1f},{:.1f}", left + 0.5 * panel + scale * 0.866 * (d.x - d.z),
                         30 + 0.5 * panel + scale * (0.5 * (d.x + d.z) - d.y));
    };
    svg += fmt::format("<text x='{}' y='20' font-size='16'>({}) {} node{}, {} filled</text>\n", left + 20,
                       static_cast<char>('a' + depth), nodes, nodes == 1 ? "" : "s", cells.size());
    for (const Filled& filled : cells) {
      const auto corner = [&](int i) { return point(filled.cell.corner(i)); };
      constexpr int faces[3][4] = {{1, 3, 7, 5}, {2, 3, 7, 6}, {4, 5, 7, 6}};  // those that are seen
      constexpr const char* shades[3] = {"#8fb4d4", "#c9dcec", "#6f9bc0"};
      for (std::size_t f = 0; f < 3; ++f)
        svg +=
            fmt::format("<path d='M{}L{}L{}L{}Z' fill='{}' stroke='#333' stroke-width='0.7'/>\n", corner(faces[f][0]),
                        corner(faces[f][1]), corner(faces[f][2]), corner(faces[f][3]), shades[f]);
    }
  }
  return svg + "</svg>\n";
}

TriangleSoup plane_example() {
  TriangleSoup soup;
  add_fan(soup, {{1.6f, 6.1f}, {2.0f, 5.7f}, {7.3f, 11.0f}, {6.9f, 11.4f}});
  add_fan(soup, {{7.5f, 8.6f}, {10.1f, 8.6f}, {10.1f, 11.2f}, {7.5f, 11.2f}});
  std::vector<glm::vec2> circle;
  for (int i = 0; i < 32; ++i) {
    const double angle = 2.0 * 3.14159265358979 * i / 32;
    circle.emplace_back(11.6 + 1.7 * std::cos(angle), 6.9 + 1.7 * std::sin(angle));
  }
  add_fan(soup, circle);
  return soup;
}

}  // namespace sightline::cli
