// sightline detail: detail culling along a path, its error in lost pixels, and the pair of pictures (checklist 26.04).
#include <fmt/format.h>

#include <algorithm>

#include "camera.hpp"
#include "interrupt.hpp"
#include "json_output.hpp"
#include "picture.hpp"
#include "scene_argument.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/registry.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

struct Worst {
  std::size_t frame = 0;
  std::uint64_t lost = 0;
  View view;
  VisibleSet drawn;
};

/// Off on the left, on on the right with red where the nearest surface has gone.
Picture pair(const IndexedScene& indexed, const Worst& worst) {
  const VisibleSet all = VisibleSet::all(indexed.scene.objects().size());
  const auto renderer = make_renderer("zbuffer", indexed);
  Frame off, on;
  Counters counters;
  renderer->draw(worst.view, all, off, counters);
  renderer->draw(worst.view, worst.drawn, on, counters);
  const Picture a = paint(indexed.scene, worst.view, off, Show::shaded);
  Picture b = paint(indexed.scene, worst.view, on, Show::shaded);
  for (std::size_t i = 0; i < off.object.size(); ++i)
    if (off.object[i] != on.object[i]) {
      b.rgb[3 * i] = 230;
      b.rgb[3 * i + 1] = b.rgb[3 * i + 2] = 30;
    }
  const auto row = static_cast<std::ptrdiff_t>(a.width) * 3;
  Picture both{2 * a.width + 4, a.height, {}};
  for (std::ptrdiff_t y = 0; y < a.height; ++y) {
    both.rgb.insert(both.rgb.end(), a.rgb.begin() + y * row, a.rgb.begin() + (y + 1) * row);
    both.rgb.insert(both.rgb.end(), 12, 255);
    both.rgb.insert(both.rgb.end(), b.rgb.begin() + y * row, b.rgb.begin() + (y + 1) * row);
  }
  return both;
}

}  // namespace

int run_detail(const DetailOptions& options) {
  catch_interrupts();
  as_usage([&] { (void)find_algorithm(parse_method(options.method).name, Family::culler); });
  std::optional<OutputFile> picture;
  if (!options.output.empty()) picture.emplace(options.output);
  JsonOutput output(options.common);
  const LoadedScene loaded = open_scene(options.scene, options.common);
  CameraPath path = open_path(options.path, options.camera, loaded.scene, options.common.seed);
  const IndexedScene indexed = index_scene(loaded.scene);
  const auto culler = as_usage([&] { return make_culler(options.method, indexed); });
  const auto frustum = make_culler("frustum_linear", indexed);
  const Oracle oracle(loaded.scene);
  const VisibleSet all = VisibleSet::all(loaded.scene.objects().size());
  Worst worst;
  Progress progress("frames", path.views.size(), options.common.quiet);
  std::uint64_t in_view = 0, drawn = 0, seen = 0, lost = 0, lost_objects = 0, covered = 0;
  for (std::size_t v = 0; v < path.views.size(); ++v) {
    VisibleSet visible, before;
    Counters counters;
    culler->cull(path.views[v], all, visible, counters);
    frustum->cull(path.views[v], all, before, counters);
    const Truth truth = oracle.look(path.views[v]);
    const Verdict verdict = judge(truth, visible);
    in_view += before.count();
    drawn += visible.count();
    seen += truth.seen.count();
    lost += verdict.missed_samples;
    lost_objects += verdict.missed.size();
    for (const std::uint32_t samples : truth.samples) covered += samples;
    if (v == 0 || verdict.missed_samples > worst.lost)
      worst = {v, verdict.missed_samples, path.views[v], std::move(visible)};
    progress.show(v + 1);
    if (interrupted()) path.views.resize(v + 1);  // what is there is kept
  }
  const auto mean = [&](std::uint64_t sum) {
    return static_cast<double>(sum) / static_cast<double>(std::max<std::size_t>(path.views.size(), 1));
  };
  const Json json{{"schema", "sightline.detail/1"},
                  {"scene", options.scene},
                  {"method", options.method},
                  {"frames", path.views.size()},
                  {"in_frustum", mean(in_view)},
                  {"drawn", mean(drawn)},
                  {"seen", mean(seen)},
                  {"lost_objects", mean(lost_objects)},
                  {"lost_pixels", mean(lost)},
                  {"covered_pixels", mean(covered)},
                  {"worst_frame", worst.frame},
                  {"worst_lost_pixels", worst.lost}};
  if (options.common.prints())
    fmt::print(
        "{}: of {:.1f} objects in the frustum a frame {:.1f} are drawn; {:.1f} of {:.1f} seen are lost, with {:.1f} of "
        "{:.0f} pixels; worst "
        "frame {}: {} pixels\n",
        options.method, mean(in_view), mean(drawn), mean(lost_objects), mean(seen), mean(lost), mean(covered),
        worst.frame, worst.lost);
  if (picture && !path.views.empty()) {
    picture->write(encode_png(pair(indexed, worst)));
    picture->commit();
  }
  output.write(json);
  return interrupted() ? exit_interrupted : exit_ok;
}

}  // namespace sightline::cli
