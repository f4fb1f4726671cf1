// sightline persistence: how long what is hidden stays hidden, on a walk through a scene.
#include <fmt/format.h>

#include <cmath>

#include "camera.hpp"
#include "interrupt.hpp"
#include "json_output.hpp"
#include "line_plot.hpp"
#include "persistence_measure.hpp"
#include "scene_argument.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/registry.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

/// Interrupted, it leaves those of the views that were measured.
Persistence measure(const PersistenceOptions& options, const Scene& scene, std::vector<View>& views) {
  const IndexedScene indexed = index_scene(scene);
  const Oracle oracle(scene);
  const auto frustum_culler = make_culler("frustum_hierarchical", indexed);
  const VisibleSet all = VisibleSet::all(scene.objects().size());
  Persistence persistence(scene.objects().size(), options.longest);
  Progress progress("frames", views.size(), options.common.quiet);
  VisibleSet frustum;
  Counters unused;
  for (std::size_t i = 0; i < views.size(); ++i) {
    frustum_culler->cull(views[i], all, frustum, unused);
    persistence.frame(frustum, oracle.look(views[i]).seen);
    progress.show(i + 1);
    if (interrupted()) views.resize(i + 1);
  }
  return persistence;
}

LinePlot plot_of(const PersistenceOptions& options, const std::vector<double>& keep, const PersistenceFit& fit) {
  LinePlot plot{"Probability of staying hidden: " + options.scene, "frames hidden before", "p(t)", false, 0.2, 1.0, {}};
  PlotCurve measured{"measured", {}, true}, fitted{"", {}, false}, paper{"0.99 - 0.7 exp(-t)", {}, false};
  for (std::size_t i = 0; i < keep.size(); ++i) {
    const auto t = static_cast<double>(i + 1);
    if (keep[i] >= 0.0) measured.points.emplace_back(t, keep[i]);
    if (fit.valid) fitted.points.emplace_back(t, fit.at(t));
    paper.points.emplace_back(t, 0.99 - 0.7 * std::exp(-t));
  }
  if (fit.valid) fitted.name = fmt::format("fit: {:.4f} - {:.4f} exp(-{:.3f} t)", fit.a, fit.b, fit.c);
  plot.curves = {measured, fitted, paper};
  return plot;
}

}  // namespace

int run_persistence(const PersistenceOptions& options) {
  catch_interrupts();
  JsonOutput output(options.common);
  std::optional<OutputFile> picture;
  if (!options.picture.empty()) picture.emplace(options.picture);
  const LoadedScene loaded = open_scene(options.scene, options.common);
  CameraPath path = open_path(options.path, options.camera, loaded.scene, options.common.seed);
  const Persistence persistence = measure(options, loaded.scene, path.views);
  const std::vector<double> keep = persistence.keep();
  const PersistenceFit fit = fit_persistence(keep, persistence.observed());

  Json json{{"schema", "sightline.persistence/1"},
            {"scene", options.scene},
            {"frames", path.views.size()},
            {"t", Json::array()},
            {"I", persistence.hidden()},
            {"observed", persistence.observed()},
            {"p", Json::array()}};
  for (std::size_t i = 0; i < keep.size(); ++i) {
    json["t"].push_back(i + 1);
    json["p"].push_back(keep[i] < 0.0 ? Json(nullptr) : Json(keep[i]));
    // The ratio of the paper's definition taken literally: dominated by what is hidden for good.
    const std::vector<std::uint64_t>& hidden = persistence.hidden();
    if (i + 1 < keep.size() && hidden[i] > 0)
      json["I_ratio"].push_back(static_cast<double>(hidden[i + 1]) / static_cast<double>(hidden[i]));
  }
  json["fit"] = fit.valid ? Json{{"a", fit.a}, {"b", fit.b}, {"c", fit.c}, {"error", fit.error}} : Json(nullptr);
  if (options.common.prints()) {
    fmt::print("{:>4} {:>12} {:>10} {:>8} {:>8}\n", "t", "I(t)", "observed", "p(t)", "fit");
    for (std::size_t i = 0; i < keep.size(); ++i)
      if (keep[i] >= 0.0)
        fmt::print("{:>4} {:>12} {:>10} {:>8.4f} {:>8.4f}\n", i + 1, persistence.hidden()[i], persistence.observed()[i],
                   keep[i], fit.valid ? fit.at(static_cast<double>(i + 1)) : 0.0);
    if (fit.valid)
      fmt::print("p(t) = {:.4f} - {:.4f} exp(-{:.4f} t), error {:.4f}; the paper's curve: 0.99 - 0.7 exp(-t)\n", fit.a,
                 fit.b, fit.c, fit.error);
    else
      fmt::print("too few hidden objects for a fit\n");
  }
  if (picture) {
    picture->write(svg_of(plot_of(options, keep, fit)));
    picture->commit();
  }
  output.write(json);
  return interrupted() ? exit_interrupted : exit_ok;
}

}  // namespace sightline::cli
