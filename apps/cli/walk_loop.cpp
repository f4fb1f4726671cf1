#include "walk_loop.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "interrupt.hpp"
#include "methods.hpp"
#include "output.hpp"
#include "picture.hpp"
#include "scene_argument.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/registry.hpp"

namespace sightline::cli {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// True for at most `limit` of `total` frames, evenly spread.
bool chosen_evenly(std::size_t frame, std::size_t total, std::size_t limit) {
  if (limit >= total) return true;
  return frame == 0 ? limit > 0 : frame * limit / total != (frame - 1) * limit / total;
}

/// How many frames may keep one byte for each object.
std::size_t state_frames(std::size_t objects, std::size_t methods) {
  constexpr std::size_t most_frames = 200, most_bytes = std::size_t{16} << 20;
  return std::min(most_frames, most_bytes / std::max<std::size_t>(objects * methods, 1));
}

std::vector<std::uint8_t> object_states(const VisibleSet& frustum, const VisibleSet& visible, const Truth* truth) {
  std::vector<std::uint8_t> states(visible.universe());
  for (std::size_t i = 0; i < states.size(); ++i) {
    const auto id = static_cast<ObjectId>(i);
    const bool seen = truth != nullptr && truth->seen.contains(id);
    ObjectState state = frustum.contains(id) ? ObjectState::hidden : ObjectState::outside;
    if (visible.contains(id))
      state = seen || truth == nullptr ? ObjectState::seen : ObjectState::extra;
    else if (seen)
      state = ObjectState::missed;
    states[i] = static_cast<std::uint8_t>(state);
  }
  return states;
}

/// Bytes in use in the main arena of the allocator and in mapped blocks.
std::size_t allocated_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

/// One method at work.
struct Contender {
  std::unique_ptr<Culler> culler;
  VisibleSet visible;
};

class Walker {
 public:
  Walker(const WalkOptions& options, WalkScene& scene, WalkReport& report)
      : options_(options),
        walk_scene_(scene),
        report_(report),
        scene_(scene.indexed().scene),
        candidates_(VisibleSet::all(scene_.objects().size())),
        frustum_culler_(make_culler("frustum_linear", scene.indexed())) {
    for (const std::string& method : options.methods) {
      WalkRun run;
      run.method = method;
      std::unique_ptr<Culler> culler;
      try {
        const ThreadLimit one(1);  // then all that it allocates is counted
        const std::size_t before = allocated_bytes();
        culler = as_usage([&] { return make_any_culler(method, scene.indexed()); });
        const std::size_t after = allocated_bytes();
        run.memory_bytes = after > before ? after - before : 0;
      } catch (const MethodUnavailable& error) {
        if (options.methods.size() == 1) throw;
        warn(fmt::format("{}: skipped: {}", method, error.what()));
        continue;
      }
      run.promise = culler->promise(find_method(parse_method(method).name, Family::culler).promise);
      if (!options.trace.empty() && traced_ == none_traced && start_trace(*culler)) traced_ = contenders_.size();
      contenders_.push_back({std::move(culler), VisibleSet()});
      report.runs.push_back(std::move(run));
    }
    if (contenders_.empty()) throw MethodUnavailable("none of the methods can run here");
    if (!options.trace.empty() && traced_ == none_traced)
      throw UsageError("--trace: none of the methods has a timeline; those named gl_... have one");
  }

  void frame(const View& view, bool with_state) {
    WalkView facts;
    facts.frame = report_.views.size();
    facts.view = view;
    facts.candidates = candidates_.count();
    std::vector<WalkAnswer> answers(contenders_.size());
    if (facts.frame > 0 && walk_scene_.moving() > 0) {
      facts.move_ms = walk_scene_.to_frame(facts.frame);
      follow(answers);
    }
    Counters unused;
    frustum_culler_->cull(view, candidates_, frustum_, unused);
    facts.frustum = frustum_.count();
    for (std::size_t i = 0; i < contenders_.size(); ++i) cull(view, contenders_[i], report_.runs[i], answers[i]);
    std::optional<Truth> truth, centres, drawn;
    if (options_.verify) {
      const auto start = Clock::now();
      truth = walk_scene_.oracle().look(view, options_.samples);
      facts.truth_ms = milliseconds_since(start);
      facts.truth = truth->seen.count();
    }
    for (std::size_t i = 0; i < contenders_.size(); ++i) {
      if (truth) {
        const Truth* const own = own_truth(*contenders_[i].culler, view, drawn);
        compare(own != nullptr ? *own : *truth, contenders_[i].visible, answers[i]);
        if (own == nullptr && options_.samples > 1 && report_.runs[i].promise == Promise::conservative) {
          if (!centres) centres = walk_scene_.oracle().look(view);
          compare_at_centres(*centres, contenders_[i].visible, answers[i]);
        }
      }
      if (with_state) answers[i].state = object_states(frustum_, contenders_[i].visible, truth ? &*truth : nullptr);
      report_.runs[i].answers.push_back(std::move(answers[i]));
    }
    report_.views.push_back(facts);
  }

  /// Hands over what --trace asks for.
  void finish() {
    if (traced_ != none_traced)
      report_.trace =
          finish_trace(*contenders_[traced_].culler, report_.runs[traced_].method, options_.trace.ends_with(".svg"));
  }

 private:
  /// Every method learns where the objects are now. Those that cannot are made anew, all of them after the old ones
  /// are gone: methods on a device share what they keep of the scene.
  void follow(std::vector<WalkAnswer>& answers) {
    if (!frustum_culler_->follow_scene()) throw std::logic_error("frustum_linear does not follow the scene");
    for (std::size_t i = 0; i < contenders_.size(); ++i) {
      const auto start = Clock::now();
      if (!contenders_[i].culler->follow_scene()) contenders_[i].culler.reset();
      answers[i].follow_ms = milliseconds_since(start);
    }
    for (std::size_t i = 0; i < contenders_.size(); ++i) {
      if (contenders_[i].culler) continue;
      const auto start = Clock::now();
      contenders_[i].culler = make_any_culler(report_.runs[i].method, walk_scene_.indexed());
      answers[i].follow_ms += milliseconds_since(start);
      report_.runs[i].made_anew = true;
    }
  }

  void cull(const View& view, Contender& contender, WalkRun& run, WalkAnswer& answer) {
    const std::size_t before = run.answers.empty() ? allocated_bytes() : 0;
    const auto start = Clock::now();
    contender.culler->cull(view, candidates_, contender.visible, run.counters);
    answer.cull_ms = milliseconds_since(start);
    if (run.answers.empty()) {  // what it allocates when first used
      const std::size_t after = allocated_bytes();
      run.memory_bytes += after > before ? after - before : 0;
    }
    answer.visible = contender.visible.count();
    for (const ObjectId id : contender.visible.order())
      answer.triangles_submitted += scene_.mesh_of(id).triangles.size();
    if (options_.ids || keeps_ids(answer.visible)) answer.visible_ids = contender.visible.sorted();
  }

  /// The report draws what was reported: its ids are kept, up to a limit on memory.
  bool keeps_ids(std::size_t count) {
    constexpr std::size_t most_ids = std::size_t{16} << 20;
    if (options_.report.empty() || kept_ids_ + count > most_ids) return false;
    kept_ids_ += count;
    return true;
  }

  static void compare(const Truth& truth, const VisibleSet& visible, WalkAnswer& answer) {
    Verdict verdict = judge(truth, visible);
    answer.missed = std::move(verdict.missed);
    answer.missed_samples = verdict.missed_samples;
    answer.extra = verdict.extra;
  }

  /// For a promise about pixel centres, which need not be among the samples: what is missed there is missed, and only
  /// the rest was not promised.
  static void compare_at_centres(const Truth& centres, const VisibleSet& visible, WalkAnswer& answer) {
    const std::vector<ObjectId> broken = judge(centres, visible).missed;
    std::vector<ObjectId> all;
    std::set_union(answer.missed.begin(), answer.missed.end(), broken.begin(), broken.end(), std::back_inserter(all));
    answer.missed = std::move(all);
    answer.unpromised = answer.missed.size() - broken.size();
  }

  const WalkOptions& options_;
  WalkScene& walk_scene_;
  WalkReport& report_;
  const Scene& scene_;
  VisibleSet candidates_, frustum_;
  std::unique_ptr<Culler> frustum_culler_;
  std::vector<Contender> contenders_;
  std::size_t kept_ids_ = 0;
  static constexpr std::size_t none_traced = ~std::size_t{0};
  std::size_t traced_ = none_traced;
};

std::size_t missed_in(const WalkReport& report, std::size_t frame) {
  std::size_t missed = 0;
  for (const WalkRun& run : report.runs) missed += run.answers[frame].missed.size();
  return missed;
}

/// Ascending indices: up to three frames with the most missed, the rest evenly spread.
std::vector<std::size_t> picture_frames(const WalkReport& report) {
  constexpr std::size_t wanted = 6;
  const std::size_t total = report.views.size();
  std::vector<std::size_t> worst;
  for (std::size_t i = 0; i < total; ++i)
    if (missed_in(report, i) > 0) worst.push_back(i);
  std::stable_sort(worst.begin(), worst.end(),
                   [&](std::size_t a, std::size_t b) { return missed_in(report, a) > missed_in(report, b); });
  worst.resize(std::min(worst.size(), wanted / 2));
  const std::size_t rest = wanted - worst.size();
  for (std::size_t i = 0; i < total; ++i)
    if (chosen_evenly(i, total, rest)) worst.push_back(i);
  std::sort(worst.begin(), worst.end());
  worst.erase(std::unique(worst.begin(), worst.end()), worst.end());
  return worst;
}

/// What drawing everything that a method reported costs: surfaces over each pixel.
std::string draw_overdraw(const Scene& scene, const View& view, const WalkAnswer& answer) {
  VisibleSet reported(scene.objects().size());
  for (const ObjectId id : answer.visible_ids) reported.insert(id);
  return encode_png(paint_overdraw(view.width, view.height, Oracle(scene, reported).count_surfaces(view)));
}

}  // namespace

void walk_frames(const WalkOptions& options, WalkScene& scene, std::span<const View> views, WalkReport& report) {
  report.moving = scene.moving();
  Walker walker(options, scene, report);
  const std::size_t keep =
      options.report.empty() ? 0 : state_frames(scene.indexed().scene.objects().size(), report.runs.size());
  Progress progress("frames", views.size(), options.common.quiet);
  for (std::size_t i = 0; i < views.size(); ++i) {
    walker.frame(views[i], chosen_evenly(i, views.size(), keep));
    progress.show(i + 1);
    if (interrupted()) {
      report.interrupted = true;
      break;
    }
  }
  walker.finish();
}

std::vector<WalkPicture> draw_pictures(const WalkReport& report, WalkScene& scene) {
  constexpr std::pair<Show, const char*> kinds[] = {
      {Show::shaded, "shaded"}, {Show::object, "object"}, {Show::depth, "depth"}};
  constexpr std::size_t most_overdraws = 3;
  std::vector<WalkPicture> pictures;
  Frame frame;
  for (const std::size_t i : picture_frames(report)) {
    View view = report.views[i].view;
    // As large as fits into 640 x 360 with the proportions of the walk: the picture shows what the walk saw.
    const double scale = std::min(640.0 / view.width, 360.0 / view.height);
    view.width = std::max(1, static_cast<int>(std::lround(view.width * scale)));
    view.height = std::max(1, static_cast<int>(std::lround(view.height * scale)));
    scene.to_frame(report.views[i].frame);
    scene.oracle().draw(view, frame);
    for (const auto& [show, name] : kinds)
      pictures.push_back({report.views[i].frame, name, encode_png(paint(*report.scene, view, frame, show))});
    for (std::size_t run = 0; run < std::min(report.runs.size(), most_overdraws); ++run) {
      const WalkAnswer& answer = report.runs[run].answers[i];
      if (answer.visible_ids.size() != answer.visible) continue;  // not kept
      const std::string kind = run == 0 ? "overdraw" : "overdraw of " + report.runs[run].method;
      pictures.push_back({report.views[i].frame, kind, draw_overdraw(*report.scene, view, answer)});
    }
  }
  scene.to_frame(0);
  return pictures;
}

}  // namespace sightline::cli
