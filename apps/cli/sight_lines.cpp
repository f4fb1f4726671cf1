// sightline sight-lines: whether points see each other, and if not, which object blocks where.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "arguments.hpp"
#include "json_output.hpp"
#include "query_options.hpp"
#include "scene_argument.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/scene_rays.hpp"
#include "sightline/scene/load/file_bytes.hpp"

namespace sightline::cli {
namespace {

constexpr std::size_t most_lines = 50'000'000;

/// Three numbers at the start of a line, blanks or commas between; nothing for an empty line or a comment.
std::optional<glm::dvec3> point_of(const std::string& file, std::size_t number, std::string_view line) {
  line = line.substr(0, line.find('#'));
  glm::dvec3 point(0.0);
  const char* at = line.data();
  const char* const end = line.data() + line.size();
  const auto skip = [&] {
    while (at < end && (*at == ' ' || *at == '\t' || *at == ',' || *at == '\r')) ++at;
  };
  skip();
  if (at == end) return std::nullopt;
  for (int axis = 0; axis < 3; ++axis) {
    skip();
    const auto [next, error] = std::from_chars(at, end, point[axis]);
    if (error != std::errc{} || !std::isfinite(point[axis]) || std::abs(point[axis]) > largest_distance)
      throw InputError(file, "line " + std::to_string(number), "must begin with three numbers");
    at = next;
  }
  return point;
}

std::vector<glm::dvec3> points_of(const std::string& option, const std::string& text) {
  if (std::count(text.begin(), text.end(), ',') == 2 && !std::filesystem::exists(text)) {
    const glm::dvec3 point = parse_vector(option, text);
    if (!(glm::length(point) <= largest_distance))
      throw UsageError(fmt::format("{}: '{}' is farther than 1e15 m from the origin", option, text));
    return {point};
  }
  const Bytes bytes = read_file(text);
  std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::vector<glm::dvec3> points;
  for (std::size_t line = 1; !rest.empty(); ++line) {
    const std::size_t length = std::min(rest.find('\n'), rest.size());
    if (const auto point = point_of(text, line, rest.substr(0, length))) points.push_back(*point);
    rest.remove_prefix(std::min(length + 1, rest.size()));
  }
  if (points.empty()) throw InputError(text, "", "has no points");
  return points;
}

struct Line {
  glm::dvec3 from, to;
  bool visible = true;
  SceneRayHit hit;
  glm::dvec3 where{0.0};
};

std::vector<Line> lines_between(const SightLinesOptions& options) {
  const std::vector<glm::dvec3> from = points_of("--from", options.from), to = points_of("--to", options.to);
  std::vector<Line> lines;
  if (options.pairs) {
    if (from.size() != to.size())
      throw UsageError(fmt::format("--pairs: {} points cannot pair with {}", from.size(), to.size()));
    for (std::size_t i = 0; i < from.size(); ++i) lines.push_back({from[i], to[i], true, {}, {}});
    return lines;
  }
  if (from.size() > most_lines / to.size())
    throw UsageError(fmt::format("{} times {} lines are more than {}", from.size(), to.size(), most_lines));
  for (const glm::dvec3& a : from)
    for (const glm::dvec3& b : to) lines.push_back({a, b, true, {}, {}});
  return lines;
}

void look(const SceneRays& rays, const SightLinesOptions& options, Line& line) {
  const glm::dvec3 way = line.to - line.from;
  const double length = glm::length(way);
  if (!(length > 2.0 * options.margin)) return;
  const double margin = options.margin / length;
  const auto blockers = options.glass ? SceneRays::Blockers::all : SceneRays::Blockers::opaque;
  if (!rays.nearest({line.from, way, margin, 1.0 - margin}, line.hit, blockers)) return;
  line.visible = false;
  line.where = line.from + line.hit.t * way;
}

Json line_json(const Scene& scene, const Line& line) {
  Json json{{"from", vector_json(line.from)}, {"to", vector_json(line.to)}, {"visible", line.visible}};
  if (!line.visible)
    json["blocked_by"] = {{"object", line.hit.object},
                          {"name", scene.name(line.hit.object)},
                          {"triangle", line.hit.triangle},
                          {"point", vector_json(line.where)},
                          {"distance", line.hit.t * glm::length(line.to - line.from)}};
  return json;
}

void print_line(const Scene& scene, const Line& line) {
  const auto text = [](const glm::dvec3& v) { return fmt::format("{:.6g},{:.6g},{:.6g}", v.x, v.y, v.z); };
  fmt::print("{} -> {}: ", text(line.from), text(line.to));
  if (line.visible)
    fmt::print("visible\n");
  else
    fmt::print("blocked by object {} '{}', triangle {}, at {}\n", line.hit.object, scene.name(line.hit.object),
               line.hit.triangle, text(line.where));
}

}  // namespace

int run_sight_lines(const SightLinesOptions& options) {
  JsonOutput output(options.common);
  std::vector<Line> lines = lines_between(options);
  const LoadedScene loaded = open_scene(options.scene, options.common);
  const SceneRays rays(loaded.scene);
  const auto start = std::chrono::steady_clock::now();
  parallel_blocks(lines.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) look(rays, options, lines[i]);
  });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::size_t visible = 0;
  for (const Line& line : lines) visible += line.visible ? 1 : 0;
  if (options.common.prints()) {
    for (const Line& line : lines) print_line(loaded.scene, line);
    if (lines.size() > 1) fmt::print("{} of {} lines of sight are free; {:.3f} s\n", visible, lines.size(), seconds);
  }
  if (!options.common.json.empty()) {
    Json json{{"schema", "sightline.sight-lines/1"},
              {"scene", options.scene},
              {"lines", Json::array()},
              {"visible", visible},
              {"seconds", seconds}};
    for (const Line& line : lines) json["lines"].push_back(line_json(loaded.scene, line));
    output.write(json);
  }
  return exit_ok;
}

}  // namespace sightline::cli
