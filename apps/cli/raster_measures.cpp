#include "raster_measures.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "sightline/oracle/oracle.hpp"
#include "sightline/raster/depth_precision.hpp"
#include "sightline/raster/pipeline.hpp"
#include "sightline/raster/scene_draw.hpp"
#include "sightline/raster/tile_memory.hpp"
#include "sightline/raster/tile_rasteriser.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/generate/random.hpp"

namespace sightline::cli {
namespace {

double milliseconds(const std::chrono::steady_clock::time_point& start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

std::uint64_t covered_pixels(const Frame& frame) {
  return static_cast<std::uint64_t>(
      std::count_if(frame.object.begin(), frame.object.end(), [](ObjectId id) { return id != no_object; }));
}

double per(std::uint64_t count, std::uint64_t of) {
  return of == 0 ? 0.0 : static_cast<double>(count) / static_cast<double>(of);
}

Json draw_counting(const char* method, const IndexedScene& indexed, const View& view, Frame& frame) {
  Counters counters;
  const auto renderer = make_renderer(std::string(method) + ":overdraw=on", indexed);
  const auto start = std::chrono::steady_clock::now();
  renderer->draw(view, VisibleSet::all(indexed.scene.objects().size()), frame, counters);
  const double ms = milliseconds(start);
  return {{"ms", ms},
          {"triangles_drawn", counters.triangles_in},
          {"depth_tests", counters.pixels_tested},
          {"depth_writes", counters.pixels_written},
          {"writes_per_covered_pixel", per(counters.pixels_written, covered_pixels(frame))}};
}

struct Order {
  const char* name;
  std::vector<ObjectId> objects;
};

std::vector<Order> three_orders(const Scene& scene, const View& view) {
  std::vector<Order> orders{{"front_to_back", raster::front_to_back(scene, view)}};
  orders.push_back({"back_to_front", {orders[0].objects.rbegin(), orders[0].objects.rend()}});
  std::vector<ObjectId> shuffled = orders[0].objects;
  Random random(1);
  for (std::size_t i = shuffled.size(); i > 1; --i)
    std::swap(shuffled[i - 1], shuffled[random.below(static_cast<std::uint32_t>(i))]);
  orders.push_back({"random", std::move(shuffled)});
  return orders;
}

raster::DrawCounts draw_into(const Scene& scene, const View& view, const std::vector<ObjectId>& order,
                             const raster::SceneDraw& what, raster::Target& target, double& ms) {
  raster::DrawCounts counts;
  const auto start = std::chrono::steady_clock::now();
  raster::draw_scene(scene, view, order, what, target, counts);
  ms = milliseconds(start);
  return counts;
}

/// Every pixel under triangles of its own: quads with tilts, so that pixels of one draw see different orders.
struct TiltedQuads {
  static constexpr std::size_t varyings = 0;
  static constexpr bool discards = false, writes_depth = false;
  std::vector<glm::vec4> corners;  // four per quad
  [[nodiscard]] raster::ClipVertex<0> vertex(std::uint32_t i) const { return {corners[i], {}}; }
  static bool fragment(const raster::Fragment<0>&, raster::FragmentResult&) { return true; }
};

}  // namespace

Json measure_overdraw(const Scene& scene, const View& view, Frame& plain, Frame& hierarchical) {
  const IndexedScene indexed = index_scene(scene);
  Json json{{"triangles", scene.triangle_count()}, {"objects", scene.objects().size()}};
  json["plain"] = draw_counting("zbuffer_tiled", indexed, view, plain);
  json["hierarchical"] = draw_counting("hzb", indexed, view, hierarchical);
  json["covered_pixels"] = covered_pixels(plain);
  json["same_image"] = plain.object == hierarchical.object && plain.depth == hierarchical.depth;
  return json;
}

Json measure_complexity(const Scene& scene, const View& view) {
  const auto orders = three_orders(scene, view);
  double ms = 0;
  // a: surfaces along the rays, by the oracle.
  std::uint64_t intersections = 0;
  for (const std::uint8_t n : Oracle(scene).count_surfaces(view)) intersections += n;
  // b: fragments that the pipeline makes; no test.
  raster::Target polygons(view.width, view.height), transparent = polygons, tests = polygons;
  polygons.count_pixels();
  raster::SceneDraw untested;
  untested.state.depth.enabled = false;
  draw_into(scene, view, orders[0].objects, untested, polygons, ms);
  std::uint64_t layers = 0, covered = 0;
  std::uint32_t most = 0;
  for (const std::uint32_t n : polygons.counts.fragments) {
    layers += n;
    covered += n > 0 ? 1 : 0;
    most = std::max(most, n);
  }
  // c: everything is glass and blended back to front: the layers that the stencil counts.
  raster::SceneDraw glass;
  glass.alpha = 0.5f;
  glass.state.blend = raster::blend_over();
  glass.state.depth.mask = false;
  glass.state.stencil.enabled = true;
  glass.state.stencil.front.zpass = glass.state.stencil.back.zpass = raster::StencilOp::incr;
  draw_into(scene, view, orders[1].objects, glass, transparent, ms);
  const std::uint64_t blended =
      std::accumulate(transparent.stencil.begin(), transparent.stencil.end(), std::uint64_t{0});
  // d: what lies behind the surface that is seen. e: z-tests, of which back-face culling spares some.
  raster::SceneDraw behind, culled;
  behind.state.depth.func = raster::Compare::greater;
  behind.state.depth.mask = false;
  culled.state.cull = raster::CullFace::back;
  raster::Target nearest(view.width, view.height);
  draw_into(scene, view, orders[0].objects, {}, nearest, ms);
  const raster::DrawCounts d = draw_into(scene, view, orders[0].objects, behind, nearest, ms);
  const raster::DrawCounts e = draw_into(scene, view, orders[0].objects, culled, tests, ms);
  Json json{{"covered_pixels", covered},
            {"largest", most},
            {"a_intersections_per_ray", per(intersections, covered)},
            {"b_polygons_per_pixel", per(layers, covered)},
            {"c_visible_if_transparent", per(blended, covered)},
            {"d_polygons_behind", per(d.depth_tests - d.depth_failed, covered)},
            {"e_depth_tests_back_faces_culled", per(e.depth_tests, covered)}};
  for (const Order& order : orders) {
    raster::Target target(view.width, view.height);
    const raster::DrawCounts c = draw_into(scene, view, order.objects, {}, target, ms);
    json["orders"][order.name] = {{"depth_tests_per_covered_pixel", per(c.depth_tests, covered)},
                                  {"depth_writes_per_covered_pixel", per(c.depth_writes, covered)},
                                  {"colour_writes_per_covered_pixel", per(c.colour_writes, covered)}};
  }
  return json;
}

Json measure_harmonic(std::uint64_t seed) {
  Random random(seed);
  Json rows = Json::array();
  for (const int n : {1, 2, 4, 8, 16, 32, 64}) {
    constexpr int rounds = 240;
    raster::Target target(16, 16);
    raster::DrawCounts counts, front, back;
    for (int round = 0; round < rounds; ++round) {
      TiltedQuads quads;
      std::vector<glm::uvec3> triangles;
      std::vector<std::pair<float, std::uint32_t>> by_depth;
      for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(n); ++i) {
        const double z = random.range(-0.4, 0.4), dx = random.range(-0.29, 0.29), dy = random.range(-0.29, 0.29);
        for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
          quads.corners.emplace_back(x, y, z + dx * x + dy * y, 1);
        triangles.emplace_back(4 * i, 4 * i + 1, 4 * i + 2);
        triangles.emplace_back(4 * i, 4 * i + 2, 4 * i + 3);
      }
      target.clear();
      raster::draw(raster::State(), quads, std::span<const glm::uvec3>(triangles), target, counts);
      // The same number of quads that do not cross, in order of depth and against it.
      TiltedQuads flat;
      for (int i = 0; i < n; ++i)
        for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
          flat.corners.emplace_back(x, y, -0.9 + 1.8 * i / n, 1);
      target.clear();
      raster::draw(raster::State(), flat, std::span<const glm::uvec3>(triangles), target, front);
      std::reverse(triangles.begin(), triangles.end());
      target.clear();
      raster::draw(raster::State(), flat, std::span<const glm::uvec3>(triangles), target, back);
    }
    double harmonic = 0;
    for (int i = 1; i <= n; ++i) harmonic += 1.0 / i;
    const std::uint64_t pixels = 16 * 16 * rounds;
    rows.push_back({{"n", n},
                    {"random", per(counts.colour_writes, pixels)},
                    {"front_to_back", per(front.colour_writes, pixels)},
                    {"back_to_front", per(back.colour_writes, pixels)},
                    {"harmonic", harmonic},
                    {"ln_n_plus_half", std::log(n) + 0.5},
                    {"ln_n_plus_gamma", std::log(n) + 0.5772156649}});
  }
  return rows;
}

Json measure_compression(const View& view, const Frame& frame) {
  std::uint64_t cleared = 0, tiles = 0, bytes = 0, first = 0, second = 0, quarter = 0;
  std::vector<double> ratios;
  std::vector<std::uint64_t> histogram(16);
  std::uint64_t modes[raster::tile_modes] = {};
  const double far = std::isinf(view.far) ? 1e9 : view.far;
  for (int y = 0; y + 8 <= frame.height; y += 8)
    for (int x = 0; x + 8 <= frame.width; x += 8) {
      raster::DepthTile tile;
      bool empty = true;
      for (int i = 0; i < 64; ++i) {
        const double d = static_cast<double>(frame.depth[frame.index(x + i % 8, y + i / 8)]);
        empty = empty && std::isinf(d);
        tile[static_cast<std::size_t>(i)] = raster::depth_code(
            raster::DepthFormat::unorm24, std::isinf(d) ? 1.0 : raster::window_depth(d, view.near, far));
      }
      if (empty) {
        ++cleared;
        continue;
      }
      const raster::PackedTile packed = raster::encode_tile(tile);
      ++tiles;
      bytes += packed.size;
      first += raster::dpcm_first_order_bytes(tile);
      second += raster::dpcm_second_order_bytes(tile);
      ++modes[static_cast<std::size_t>(packed.mode)];
      ratios.push_back(static_cast<double>(raster::raw_tile_bytes) / packed.size);
      quarter += ratios.back() >= 4.0 ? 1 : 0;
      ++histogram[std::min<std::size_t>(15, static_cast<std::size_t>(ratios.back()))];
    }
  std::sort(ratios.begin(), ratios.end());
  const std::uint64_t raw = tiles * raster::raw_tile_bytes;
  return {{"tiles_cleared", cleared},
          {"tiles", tiles},
          {"ratio", per(raw, bytes)},
          {"ratio_with_cleared_tiles", per(raw + cleared * raster::raw_tile_bytes, bytes)},
          {"first_order_dpcm", per(raw, first)},
          {"second_order_dpcm", per(raw, second)},
          {"median_ratio", ratios.empty() ? 0.0 : ratios[ratios.size() / 2]},
          {"share_at_least_4", per(quarter, tiles)},
          {"modes",
           {{"plane", modes[0]},
            {"two_planes", modes[1]},
            {"second_order", modes[2]},
            {"second_order_turned", modes[3]},
            {"mixed", modes[4]},
            {"raw", modes[5]}}},
          {"histogram", histogram}};
}

Json measure_traffic(const Scene& scene, const View& view) {
  struct Setting {
    const char* name;
    raster::TileFeatures features;
  };
  const Setting settings[] = {{"none", {false, false, false}},
                              {"fast_clear", {true, false, false}},
                              {"zmax", {false, true, false}},
                              {"compression", {false, false, true}},
                              {"all", {true, true, true}}};
  const glm::dmat4 to_clip = view_projection(view);
  Json json = Json::object();
  double none = 0;
  for (const Setting& setting : settings) {
    raster::TileMemory memory(view.width, view.height, setting.features);
    std::vector<raster::ClipVertex<0>> polygon, scratch;
    for (const ObjectId id : raster::front_to_back(scene, view)) {
      const Object& object = scene.objects()[id];
      const Mesh& mesh = scene.meshes()[object.mesh];
      for (const glm::uvec3& t : mesh.triangles) {
        polygon.clear();
        for (int k = 0; k < 3; ++k)
          polygon.push_back(
              {glm::vec4(to_clip * glm::dvec4(transform_point(object.transform, mesh.positions[t[k]]), 1.0)), {}});
        raster::clip_polygon(polygon, scratch, view.width, view.height);
        for (std::size_t i = 2; i < polygon.size(); ++i)
          memory.draw({raster::viewport_transform(polygon[0].position, view.width, view.height),
                       raster::viewport_transform(polygon[i - 1].position, view.width, view.height),
                       raster::viewport_transform(polygon[i].position, view.width, view.height)});
      }
    }
    const raster::TileTraffic& t = memory.traffic();
    if (none == 0) none = static_cast<double>(t.total());
    json[setting.name] = {{"bytes_read", t.read},
                          {"bytes_written", t.written},
                          {"bytes_cleared", t.cleared},
                          {"bytes", t.total()},
                          {"gain", none / std::max(1.0, static_cast<double>(t.total()))},
                          {"tile_visits", t.visits},
                          {"rejected_by_vertices", t.rejected[0]},
                          {"rejected_by_corners", t.rejected[1]},
                          {"rejected_by_fragments", t.rejected[2]},
                          {"fetches", t.fetches}};
  }
  return json;
}

Json measure_bandwidth(const View& view, double depth_complexity) {
  Json rows = Json::array();
  const auto row = [&](const char* name, double width, double height, double complexity, double words, double fps) {
    rows.push_back({{"case", name},
                    {"width", width},
                    {"height", height},
                    {"depth_complexity", complexity},
                    {"words_per_fragment", words},
                    {"bytes_per_word", 4},
                    {"frames_per_second", fps},
                    {"megabytes_per_frame", width * height * complexity * words * 4 / 1e6},
                    {"gigabytes_per_second", width * height * complexity * words * 4 * fps / 1e9}});
  };
  row("slide: z read, z write, colour write, 2 texture reads", 1280, 1024, 4, 5, 60);
  row("frame rate at which that makes 18 GB/s", 1280, 1024, 4, 5, 18e9 / (1280.0 * 1024 * 4 * 5 * 4));
  row("the same with bilinear texture reads (4 texels each)", 1280, 1024, 4, 11, 18e9 / (1280.0 * 1024 * 4 * 11 * 4));
  row("this view, 5 words", view.width, view.height, depth_complexity, 5, 60);
  return rows;
}

Json measure_early_z(const Scene& scene, const View& view) {
  constexpr int cost = 40;
  Json json = Json::object();
  for (const Order& order : three_orders(scene, view)) {
    double ms = 0, pre_ms = 0;
    raster::SceneDraw late, early, depth_only, shading;
    late.cost = early.cost = shading.cost = cost;
    late.state.early_tests = false;
    depth_only.state.color_mask = {false, false, false, false};
    shading.state.depth.func = raster::Compare::equal;
    shading.state.depth.mask = false;
    raster::Target target(view.width, view.height);
    const auto row = [](const raster::DrawCounts& c, double time) {
      return Json{{"program_runs", c.program_runs}, {"colour_writes", c.colour_writes}, {"ms", time}};
    };
    Json& rows = json[order.name];
    const auto late_counts = draw_into(scene, view, order.objects, late, target, ms);
    rows["late_tests"] = row(late_counts, ms);
    target.clear();
    const auto early_counts = draw_into(scene, view, order.objects, early, target, ms);
    rows["early_tests"] = row(early_counts, ms);
    target.clear();
    draw_into(scene, view, order.objects, depth_only, target, pre_ms);
    const auto second = draw_into(scene, view, order.objects, shading, target, ms);
    rows["depth_pre_pass"] = row(second, pre_ms + ms);
  }
  // On the fast path, medians of five: z alone against z and ids (4.07), and what the hierarchy does for a depth
  // pre-pass (4.10).
  std::vector<double> ms[3];
  const raster::TileSettings ways[3] = {{.ids = false}, {.ids = true}, {.ids = false, .hierarchical = true}};
  const auto order = raster::front_to_back(scene, view);
  const raster::TileRasteriser rasteriser(scene);
  Frame frame;
  for (int round = 0; round < 5; ++round)
    for (std::size_t way = 0; way < 3; ++way) {
      raster::TileStats stats;
      const auto start = std::chrono::steady_clock::now();
      rasteriser.draw(view, order, ways[way], frame, stats);
      ms[way].push_back(milliseconds(start));
    }
  for (auto& times : ms) std::sort(times.begin(), times.end());
  json["z_only_ms"] = ms[0][2];
  json["z_and_ids_ms"] = ms[1][2];
  json["z_only_gain"] = ms[1][2] / ms[0][2];
  json["z_only_hierarchical_ms"] = ms[2][2];
  json["hierarchical_pre_pass_gain"] = ms[0][2] / ms[2][2];
  return json;
}

Json measure_fighting(const View& view) {
  const double near = view.near, far = std::isinf(view.far) ? 1e6 : view.far, apart = 0.01;
  Json rows = Json::array();
  for (const auto& [name, format] :
       {std::pair{"unorm16", raster::DepthFormat::unorm16}, std::pair{"unorm20", raster::DepthFormat::unorm20},
        std::pair{"unorm24", raster::DepthFormat::unorm24}, std::pair{"float32", raster::DepthFormat::float32}}) {
    double first = 0, half = 0;  // where a pixel is lost, and where half of them are
    for (double d = near * 1.02; d < 4 * far && half == 0; d *= 1.01) {
      const double share = raster::fighting_share(format, d, apart, near, far);
      if (share > 0 && first == 0) first = d;
      if (share >= 0.5) half = d;
    }
    rows.push_back({{"format", name},
                    {"near", near},
                    {"far", far},
                    {"apart", apart},
                    {"predicted_metres", raster::fighting_distance(format, apart, near, far)},
                    {"measured_metres", first},
                    {"half_lost_metres", half}});
  }
  return rows;
}

Json measure_just_noticeable(const View& view) {
  const double near = view.near, far = std::isinf(view.far) ? 1e6 : view.far;
  Json rows = Json::array();
  for (double d = 1.0; d <= 1024.0; d *= 2)
    rows.push_back({{"metres", d},
                    {"occlusion", raster::occlusion_threshold},
                    {"relative_size", raster::relative_size_threshold},
                    {"two_eyes", raster::stereo_threshold(d) / d},
                    {"unorm16", raster::depth_step_at(raster::DepthFormat::unorm16, d, near, far) / d},
                    {"unorm20", raster::depth_step_at(raster::DepthFormat::unorm20, d, near, far) / d},
                    {"unorm24", raster::depth_step_at(raster::DepthFormat::unorm24, d, near, far) / d}});
  return rows;
}

}  // namespace sightline::cli
