// sightline sigma: how many boxes an object is worth (checklist 24.05-24.07).
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "camera.hpp"
#include "interrupt.hpp"
#include "json_output.hpp"
#include "line_plot.hpp"
#include "picture.hpp"
#include "scene_argument.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/generate/shapes.hpp"
#include "sightline/scene/occludee_bounds.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

struct Row {
  double sigma = 1.0;
  double boxes = 0.0, surface = 0.0, volume = 0.0;  // per object; ratios to the single boxes, summed over objects
  std::size_t reported = 0, seen = 0, missed = 0;
  std::size_t broken = 0;               // missed in spite of a promise
  double queries = 0.0;                 // a frame
  double cull_ms = 0.0, draw_ms = 0.0;  // medians; drawing all that was reported
  [[nodiscard]] double frame_ms() const { return cull_ms + draw_ms; }
  [[nodiscard]] double false_visible() const { return static_cast<double>(reported - (seen - missed)); }
};

void measure_boxes(const Scene& scene, const OccludeeBounds& bounds, Row& row) {
  double surface = 0.0, volume = 0.0, one_surface = 0.0, one_volume = 0.0;
  for (ObjectId id = 0; id < scene.objects().size(); ++id) {
    const Aabb& box = scene.objects()[id].bounds;
    if (box.empty()) continue;
    surface += union_surface(bounds.boxes(id));
    volume += union_volume(bounds.boxes(id));
    one_surface += 2.0 * static_cast<double>(box.half_area());
    one_volume += union_volume({&box, 1});
  }
  row.boxes =
      static_cast<double>(bounds.count()) / static_cast<double>(std::max<std::size_t>(scene.objects().size(), 1));
  row.surface = one_surface > 0.0 ? surface / one_surface : 1.0;
  row.volume = one_volume > 0.0 ? volume / one_volume : 1.0;
}

/// Interrupted, it leaves those of the views that were looked at.
std::vector<Row> sweep(const SigmaOptions& options, const IndexedScene& indexed, std::vector<View>& views) {
  using Clock = std::chrono::steady_clock;
  std::vector<Row> rows;
  std::vector<std::unique_ptr<Culler>> cullers;
  for (const double sigma : options.sigmas) {
    Row& row = rows.emplace_back();
    row.sigma = sigma;
    measure_boxes(indexed.scene, OccludeeBounds(indexed.scene, {.sigma = sigma}), row);
    cullers.push_back(
        as_usage([&] { return make_culler(fmt::format("{}:tight={}", options.method, sigma), indexed); }));
  }
  const Promise of_row = find_algorithm(parse_method(options.method).name, Family::culler).promise;
  const Oracle oracle(indexed.scene);
  const VisibleSet all = VisibleSet::all(indexed.scene.objects().size());
  const auto renderer = make_renderer("zbuffer_tiled", indexed);
  Frame frame;
  std::vector<std::vector<double>> cull_times(rows.size()), draw_times(rows.size());
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  };
  Progress progress("frames", views.size(), options.common.quiet);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const Truth truth = oracle.look(views[v]);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      VisibleSet visible;
      Counters counters;
      const auto start = Clock::now();
      cullers[i]->cull(views[v], all, visible, counters);
      cull_times[i].push_back(since(start));
      const auto drawing = Clock::now();
      renderer->draw(views[v], visible, frame, counters);
      draw_times[i].push_back(since(drawing));
      const Verdict verdict = judge(truth, visible);
      rows[i].reported += visible.count();
      rows[i].seen += truth.seen.count();
      rows[i].missed += verdict.missed.size();
      if (cullers[i]->promise(of_row) != Promise::approximate) rows[i].broken += verdict.missed.size();
      rows[i].queries += static_cast<double>(counters.queries);
    }
    progress.show(v + 1);
    if (interrupted()) views.resize(v + 1);
  }
  const auto median = [](std::vector<double>& times) {
    std::sort(times.begin(), times.end());
    return times.empty() ? 0.0 : times[times.size() / 2];
  };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].cull_ms = median(cull_times[i]);
    rows[i].draw_ms = median(draw_times[i]);
    rows[i].queries /= static_cast<double>(std::max<std::size_t>(views.size(), 1));
  }
  return rows;
}

/// The tight boxes of all objects as a scene of their own, seen like the scene itself.
Picture draw_boxes(const Scene& scene, View view) {
  SceneBuilder builder;
  const OccludeeBounds bounds(scene, {});
  const MeshId unit = builder.add_mesh(make_box({0, 0, 0}, {1, 1, 1}));
  for (ObjectId id = 0; id < scene.objects().size(); ++id)
    for (const Aabb& box : bounds.boxes(id)) {
      const glm::vec3 e = box.extent();
      builder.add_object(unit, {{e.x, 0, 0}, {0, e.y, 0}, {0, 0, e.z}, box.lo});
    }
  const Scene boxes = builder.build();
  view.width = 640;
  view.height = 360;
  Frame left, right;
  Oracle(scene).draw(view, left);
  Oracle(boxes).draw(view, right);
  const Picture a = paint(scene, view, left, Show::shaded), b = paint(boxes, view, right, Show::shaded);
  Picture both{1284, 360, {}};
  for (std::size_t y = 0; y < 360; ++y) {
    both.rgb.insert(both.rgb.end(), a.rgb.begin() + static_cast<std::ptrdiff_t>(y * 1920),
                    a.rgb.begin() + static_cast<std::ptrdiff_t>((y + 1) * 1920));
    both.rgb.insert(both.rgb.end(), 12, 255);
    both.rgb.insert(both.rgb.end(), b.rgb.begin() + static_cast<std::ptrdiff_t>(y * 1920),
                    b.rgb.begin() + static_cast<std::ptrdiff_t>((y + 1) * 1920));
  }
  return both;
}

/// Everything relative to the first sigma of the sweep, usually 1: one box for each object.
LinePlot plot_of(const SigmaOptions& options, const std::vector<Row>& rows) {
  LinePlot plot{"Tight bounding volumes: " + title_of(options.scene) + ", " + options.method,
                "sigma",
                "% of the first",
                false,
                0.0,
                0.0,
                {{"false-visible", {}}, {"surface", {}}, {"queries", {}}, {"culling time", {}}, {"frame time", {}}}};
  const Row& first = rows.front();
  for (const Row& row : rows) {
    const auto add = [&](std::size_t curve, double value, double reference) {
      if (reference > 0.0) plot.curves[curve].points.emplace_back(row.sigma, 100.0 * value / reference);
    };
    add(0, row.false_visible(), first.false_visible());
    add(1, row.surface, first.surface);
    add(2, row.queries, first.queries);
    add(3, row.cull_ms, first.cull_ms);
    add(4, row.frame_ms(), first.frame_ms());
  }
  return plot;
}

}  // namespace

int run_sigma(const SigmaOptions& options) {
  catch_interrupts();
  std::optional<OutputFile> picture, plot;
  if (!options.output.empty()) picture.emplace(options.output);
  if (!options.plot.empty()) plot.emplace(options.plot);
  JsonOutput output(options.common);
  const LoadedScene loaded = open_scene(options.scene, options.common);
  CameraPath path = open_path(options.path, options.camera, loaded.scene, options.common.seed);
  const IndexedScene indexed = index_scene(loaded.scene);
  const std::vector<Row> rows = sweep(options, indexed, path.views);
  Json json{{"schema", "sightline.sigma/1"},
            {"scene", options.scene},
            {"method", options.method},
            {"frames", path.views.size()},
            {"rows", Json::array()}};
  std::size_t broken = 0;
  const bool text = options.common.prints();
  if (text)
    fmt::print("{:>6} {:>12} {:>9} {:>8} {:>10} {:>10} {:>14} {:>7} {:>10} {:>9} {:>9} {:>9}\n", "sigma",
               "boxes/object", "surface", "volume", "reported", "seen", "false-visible", "missed", "queries", "cull ms",
               "draw ms", "frame ms");
  for (const Row& row : rows) {
    broken += row.broken;
    json["rows"].push_back({{"sigma", row.sigma},
                            {"boxes_per_object", row.boxes},
                            {"surface", row.surface},
                            {"volume", row.volume},
                            {"reported", row.reported},
                            {"seen", row.seen},
                            {"false_visible", row.false_visible()},
                            {"missed", row.missed},
                            {"queries", row.queries},
                            {"cull_ms", row.cull_ms},
                            {"draw_ms", row.draw_ms}});
    if (text)
      fmt::print(
          "{:>6.2f} {:>12.2f} {:>9.3f} {:>8.3f} {:>10} {:>10} {:>14.0f} {:>7} {:>10.0f} {:>9.3f} {:>9.3f} {:>9.3f}\n",
          row.sigma, row.boxes, row.surface, row.volume, row.reported, row.seen, row.false_visible(), row.missed,
          row.queries, row.cull_ms, row.draw_ms, row.frame_ms());
  }
  if (picture) {
    picture->write(encode_png(draw_boxes(loaded.scene, path.views.front())));
    picture->commit();
  }
  if (plot) {
    plot->write(svg_of(plot_of(options, rows)));
    plot->commit();
  }
  output.write(json);
  return broken > 0 ? exit_missed : interrupted() ? exit_interrupted : exit_ok;
}

}  // namespace sightline::cli
