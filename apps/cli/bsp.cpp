// sightline bsp: what BSP trees of a scene cost by the choice of planes, and their cells in a horizontal cut.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "interrupt.hpp"
#include "json_output.hpp"
#include "picture.hpp"
#include "query_options.hpp"
#include "scene_argument.hpp"
#include "sightline/index/bsp.hpp"
#include "sightline/raster/scene_polygons.hpp"

namespace sightline::cli {
namespace {

/// The five walls of the worked example (checklist 15.06), upright on the plan (x, z), in the order of their choice.
PolygonSet worked_example() {
  constexpr double walls[5][4] = {{-1, 0, 1, 0}, {0, 2, 0, 1}, {-2, 3, 2, 3}, {3, 1.5, 3.5, -1.5}, {-1, -2, 1, -2.5}};
  PolygonSet set;
  for (const auto& w : walls) {
    const glm::dvec3 corners[4] = {{w[0], 0, w[1]}, {w[2], 0, w[3]}, {w[2], 1, w[3]}, {w[0], 1, w[1]}};
    set.add(corners);
  }
  return set;
}

std::string name_in_example(const Bsp& bsp, const BspFragment& fragment) {
  constexpr const char* names[] = {"3", "2", "1", "4", "5"};
  const std::span<const BspCorner> c = bsp.corners_of(fragment);
  const glm::dvec3 sum = c[0].position + c[1].position;
  const char* part = fragment.source == 2   ? (sum.x < 0 ? "a" : "b")
                     : fragment.source == 3 ? (sum.z > 0 ? "a" : "b")
                                            : "";
  return std::string(names[fragment.source]) + part;
}

struct Result {
  std::string splitter;
  Bsp bsp;
  double ms = 0.0;
  bool complete = true;
  double share = 1.0;  // of the work that was done
};

Result build(const BspOptions& options, const PolygonSet& polygons, const std::string& splitter) {
  Result result{splitter, {}, 0.0, true, 1.0};
  BspConfig config;
  config.seed = options.common.seed;
  config.most_fragments = static_cast<std::size_t>(options.most_fragments);
  (void)read_splitter(splitter, config.splitter);
  const auto start = std::chrono::steady_clock::now();
  const auto ms = [&] {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  };
  constexpr std::size_t steps = 1000;
  Progress progress(splitter, steps, options.common.quiet);
  config.go_on = [&](double share) {
    result.share = share;
    progress.show(static_cast<std::size_t>(share * static_cast<double>(steps)));
    return ms() <= 1e3 * options.most_seconds && !interrupted();
  };
  try {
    result.bsp = build_bsp(polygons, config);
    progress.show(steps);
  } catch (const std::length_error&) {
    result.complete = false;
  }
  result.ms = ms();
  return result;
}

/// Digits and the letters a and b, 3 x 5, for the labels of the example.
void draw_glyph(Picture& picture, char glyph, int left, int top, int scale) {
  constexpr std::string_view known = "12345ab";
  constexpr std::array<std::string_view, 7> rows{"010110010010111", "111001111100111", "111001111001111",
                                                 "101101111001001", "111100111001111", "000011101101011",
                                                 "100110101101110"};
  const std::size_t at = known.find(glyph);
  if (at == std::string_view::npos) return;
  for (int y = 0; y < 5 * scale; ++y)
    for (int x = 0; x < 3 * scale; ++x) {
      if (rows[at][static_cast<std::size_t>(y / scale * 3 + x / scale)] == '0') continue;
      const int px = left + x, py = top + y;
      if (px < 0 || py < 0 || px >= picture.width || py >= picture.height) continue;
      const auto i = static_cast<std::size_t>(py * picture.width + px) * 3;
      picture.rgb[i] = picture.rgb[i + 1] = picture.rgb[i + 2] = 0;
    }
}

/// The plan of a cut at a height: metres to pixels.
struct Plan {
  double x0, z0, scale, height;
  [[nodiscard]] glm::dvec3 at(double px, double py) const { return {x0 + px / scale, height, z0 + py / scale}; }
  [[nodiscard]] glm::dvec2 pixel(const glm::dvec3& p) const { return {(p.x - x0) * scale, (p.z - z0) * scale}; }
};

/// The leaf that holds p, as a number.
std::uint32_t leaf_of(const Bsp& bsp, const glm::dvec3& p, bool& inside) {
  std::uint32_t at = 0, cell = 0;
  while (!is_bsp_leaf(at)) {
    const bool front = bsp.nodes[at].plane.at(p) > 0.0;
    cell = 2 * at + (front ? 1 : 0);
    at = front ? bsp.nodes[at].front : bsp.nodes[at].back;
  }
  inside = at == bsp_inside;
  return cell;
}

void draw_line(Picture& picture, const glm::dvec2& a, const glm::dvec2& b, const std::array<std::uint8_t, 3>& colour,
               int half) {
  const int steps = static_cast<int>(2 * std::max(std::abs(b.x - a.x), std::abs(b.y - a.y))) + 1;
  for (int i = 0; i <= steps; ++i) {
    const glm::dvec2 p = a + (b - a) * (static_cast<double>(i) / steps);
    for (int dy = -half; dy <= half; ++dy)
      for (int dx = -half; dx <= half; ++dx) {
        const int x = static_cast<int>(p.x) + dx, y = static_cast<int>(p.y) + dy;
        if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) continue;
        std::copy(colour.begin(), colour.end(),
                  picture.rgb.begin() + static_cast<std::ptrdiff_t>(y * picture.width + x) * 3);
      }
  }
}

/// Cells in pale colours, what is inside of solids darker, and the fragments that the cut meets as lines.
Picture plan_picture(const Bsp& bsp, const Plan& plan, int width, int height, bool example) {
  Picture picture{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      bool inside = false;
      const std::uint32_t cell = leaf_of(bsp, plan.at(x + 0.5, y + 0.5), inside);
      const double hue = 6.283 * std::fmod(cell * 0.6180339887498949, 1.0);
      const double base = inside && !example ? 150 : 222;
      for (int k = 0; k < 3; ++k)
        picture.rgb.push_back(static_cast<std::uint8_t>(base + 28 * std::cos(hue + 2.094 * k)));
    }
  for (const BspFragment& fragment : bsp.fragments) {
    std::vector<glm::dvec3> ends;
    const std::span<const BspCorner> c = bsp.corners_of(fragment);
    for (std::size_t i = 0; i < c.size(); ++i) {
      const glm::dvec3 &a = c[i].position, &b = c[(i + 1) % c.size()].position;
      if ((a.y > plan.height) == (b.y > plan.height)) continue;
      ends.push_back(a + (plan.height - a.y) / (b.y - a.y) * (b - a));
    }
    if (ends.size() < 2) continue;
    const glm::dvec2 a = plan.pixel(ends[0]), b = plan.pixel(ends[1]);
    draw_line(picture, a, b, {30, 34, 44}, example ? 3 : 1);
    if (!example) continue;
    const std::string name = name_in_example(bsp, fragment);
    for (std::size_t i = 0; i < name.size(); ++i)
      draw_glyph(picture, name[i], static_cast<int>(0.5 * (a.x + b.x)) + 12 + 16 * static_cast<int>(i),
                 static_cast<int>(0.5 * (a.y + b.y)) - 32, 4);
  }
  if (example) {  // the eye
    const glm::dvec2 eye = plan.pixel({-4, 0, 1.5});
    for (int i = 0; i < 24; ++i) {
      const double t = 6.2832 * i / 24;
      draw_line(picture, eye, eye + 9.0 * glm::dvec2(std::cos(t), std::sin(t)), {200, 40, 40}, 1);
    }
  }
  return picture;
}

void write_plan(OutputFile& file, const BspOptions& options, const Bsp& bsp, bool example) {
  Aabb box;
  for (const glm::dvec3& p : bsp.polygons.corners) box.extend(glm::vec3(p));
  if (box.empty() || bsp.nodes.empty()) throw InputError(options.scene, "", "has nothing to draw");
  if (example) box.extend(glm::vec3(-4.6f, 0.5f, 0));
  const double margin = 0.05 * std::max(box.extent().x, box.extent().z) + 1e-6;
  const double w = static_cast<double>(box.extent().x) + 2 * margin,
               d = static_cast<double>(box.extent().z) + 2 * margin;
  const double scale = options.width / std::max(w, d);
  const Plan plan{static_cast<double>(box.lo.x) - margin, static_cast<double>(box.lo.z) - margin, scale,
                  options.height.value_or(example ? 0.5 : static_cast<double>(box.centre().y))};
  file.write(encode_png(plan_picture(bsp, plan, std::max(1, static_cast<int>(w * scale)),
                                     std::max(1, static_cast<int>(d * scale)), example)));
  file.commit();
}

}  // namespace

int run_bsp(const BspOptions& options) {
  const bool example = options.scene == "worked-example";
  for (BspSplitter known{}; const std::string& splitter : options.splitters)
    if (!read_splitter(splitter, known))
      throw UsageError(fmt::format("--splitter: '{}' is not {}", splitter, bsp_splitter_names));
  catch_interrupts();
  std::optional<OutputFile> file;
  if (!options.output.empty()) file.emplace(options.output);
  JsonOutput output(options.common);
  PolygonSet polygons;
  std::optional<LoadedScene> loaded;
  std::vector<std::string> splitters = options.splitters;
  if (example) {
    polygons = worked_example();
    splitters = {"first"};
  } else {
    loaded.emplace(open_scene(options.scene, options.common));
    polygons = scene_polygons(loaded->scene, 20'000'000, "bsp").polygons;
  }
  const bool print = options.common.prints();
  if (print)
    fmt::print("{:<14} {:>10} {:>10} {:>7} {:>10} {:>7} {:>8} {:>11}\n", "splitter", "polygons", "fragments", "ratio",
               "nodes", "depth", "dropped", "build ms");
  Json json{{"schema", "sightline.bsp/1"}, {"scene", options.scene}, {"trees", Json::array()}};
  for (const std::string& splitter : splitters) {
    if (interrupted()) break;
    const Result result = build(options, polygons, splitter);
    const Bsp& bsp = result.bsp;
    if (!result.complete) {
      if (print)
        fmt::print("{:<14} {:>10} given up after {:.1f} s with about {:.1f} % done ({})\n", splitter, polygons.size(),
                   1e-3 * result.ms, 100.0 * result.share,
                   interrupted()                            ? "interrupted"
                   : result.ms > 1e3 * options.most_seconds ? "--most-seconds"
                                                            : "--most-fragments");
      std::fflush(stdout);
      json["trees"].push_back({{"splitter", splitter}, {"polygons", polygons.size()}, {"complete", false}});
      continue;
    }
    const double ratio =
        static_cast<double>(bsp.fragments.size()) / static_cast<double>(std::max<std::size_t>(1, polygons.size()));
    if (print)
      fmt::print("{:<14} {:>10} {:>10} {:>7.3f} {:>10} {:>7} {:>8} {:>11.1f}\n", splitter, polygons.size(),
                 bsp.fragments.size(), ratio, bsp.nodes.size(), bsp.depth, bsp.dropped, result.ms);
    std::fflush(stdout);  // the next tree may take long
    Json row{{"splitter", splitter}, {"polygons", polygons.size()},
             {"complete", true},     {"fragments", bsp.fragments.size()},
             {"ratio", ratio},       {"nodes", bsp.nodes.size()},
             {"depth", bsp.depth},   {"dropped", bsp.dropped},
             {"build_ms", result.ms}};
    if (example) {
      row["order"] = Json::array();
      walk_bsp(bsp, {-4, 0.5, 1.5, 1}, BspOrder::far_to_near, [&](std::uint32_t node) {
        for (const BspFragment& fragment : bsp.fragments_of(bsp.nodes[node]))
          row["order"].push_back(name_in_example(bsp, fragment));
      });
      if (print) fmt::print("from far to near: {}\n", row["order"].dump());
    }
    json["trees"].push_back(row);
    if (file) write_plan(*file, options, bsp, example);
    file.reset();
  }
  output.write(json);
  return interrupted() ? exit_interrupted : exit_ok;
}

}  // namespace sightline::cli
