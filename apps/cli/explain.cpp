// sightline explain: why an object is seen or culled, for one view or for many random pairs of object and view.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>

#include "camera.hpp"
#include "explain.hpp"
#include "interrupt.hpp"
#include "output.hpp"
#include "scene_argument.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/generate/random.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

/// The object that --object names, by number or by name.
ObjectId find_object(const std::string& text, const Scene& scene) {
  ObjectId id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error == std::errc() && end == text.data() + text.size()) {
    if (id < scene.objects().size()) return id;
    throw UsageError(fmt::format("--object: {} is beyond the last of {} objects", text, scene.objects().size()));
  }
  std::vector<ObjectId> found;
  for (ObjectId i = 0; i < scene.objects().size(); ++i)
    if (scene.name(i) == text) found.push_back(i);
  if (found.empty()) throw UsageError(fmt::format("--object: no object is called '{}'", text));
  if (found.size() > 1)
    throw UsageError(fmt::format("--object: {} objects are called '{}', the first are {} and {}", found.size(), text,
                                 found[0], found[1]));
  return found.front();
}

/// A scene with a culler and its truth.
class Witnesses {
 public:
  Witnesses(const ExplainOptions& options, const Scene& scene)
      : options_(options),
        scene_(scene),
        indexed_(index_scene(scene)),
        oracle_(scene),
        culler_(as_usage([&] { return make_culler(options.method, indexed_); })),
        promise_(find_algorithm(parse_method(options.method).name, Family::culler).promise) {}

  /// The view that is asked about from now on.
  void look(const View& view) {
    view_ = view;
    truth_ = oracle_.look(view, options_.samples);
    Counters counters;
    culler_->cull(view, VisibleSet::all(scene_.objects().size()), reported_, counters);
  }

  [[nodiscard]] Judgement judge(ObjectId id) const {
    return {options_.method, promise_, reported_.contains(id), explain(scene_, oracle_, truth_, view_, id)};
  }

  [[nodiscard]] const Oracle& oracle() const { return oracle_; }
  [[nodiscard]] const Truth& truth() const { return truth_; }
  [[nodiscard]] const VisibleSet& reported() const { return reported_; }

 private:
  const ExplainOptions& options_;
  const Scene& scene_;
  IndexedScene indexed_;
  Oracle oracle_;
  std::unique_ptr<Culler> culler_;
  Promise promise_;
  View view_;
  Truth truth_;
  VisibleSet reported_;
};

/// A doubtful answer is not printed.
void refuse_doubt(const Explanation& why) {
  if (why.contradiction.empty()) return;
  throw std::logic_error(fmt::format("the explanation of object {} does not hold: {}", why.object, why.contradiction));
}

int explain_one(const ExplainOptions& options, const LoadedScene& loaded, JsonOutput& output) {
  const Scene& scene = loaded.scene;
  std::optional<OutputFile> picture;
  if (!options.output.empty()) picture.emplace(options.output);
  const ObjectId id = find_object(options.object, scene);
  const View view = single_view(options.view, loaded, options.common.seed);
  Witnesses witnesses(options, scene);
  witnesses.look(view);
  const Judgement judgement = witnesses.judge(id);
  refuse_doubt(judgement.why);
  if (picture) {
    Frame frame;
    witnesses.oracle().draw(view, frame);
    picture->write(encode_png(explanation_picture(scene, view, frame, judgement.why)));
    picture->commit();
  }
  if (!options.common.stdout_taken) fmt::print("{}", explanation_text(scene, view, judgement));
  output.write(explanation_json(scene, view, judgement));
  return judgement.broken_promise() ? exit_missed : exit_ok;
}

/// What many pairs came to.
struct Tally {
  std::uint64_t pairs = 0, missed = 0, broken = 0, conservative = 0, contradicted = 0;
  std::map<std::string, std::uint64_t> fates;
  std::vector<std::string> trouble;  // one line each, the first few

  void add(const Judgement& judgement, const View& view) {
    ++pairs;
    ++fates[std::string(to_string(judgement.why.fate))];
    missed += judgement.missed() ? 1 : 0;
    broken += judgement.broken_promise() ? 1 : 0;
    conservative += judgement.reported && judgement.why.fate != Fate::seen ? 1 : 0;
    contradicted += judgement.why.contradiction.empty() ? 0 : 1;
    constexpr std::size_t lines_kept = 10;
    const std::string wrong = judgement.missed() ? "seen but culled" : judgement.why.contradiction;
    if (!wrong.empty() && trouble.size() < lines_kept)
      trouble.push_back(fmt::format("{}: --object {} {}", wrong, judgement.why.object, describe(view)));
  }
};

/// A third each of the pairs asks about an object that is seen, one that is reported, and any.
ObjectId pick(const Witnesses& witnesses, std::uint64_t pair, Random& random) {
  const auto of = [&](const VisibleSet& set) {
    return set.order()[random.below(static_cast<std::uint32_t>(set.count()))];
  };
  const VisibleSet& seen = witnesses.truth().seen;
  const VisibleSet& reported = witnesses.reported();
  if (pair % 3 == 0 && seen.count() > 0) return of(seen);
  if (pair % 3 == 1 && reported.count() > 0) return of(reported);
  return random.below(static_cast<std::uint32_t>(seen.universe()));
}

void print_tally(const ExplainOptions& options, const Tally& tally) {
  std::string line = fmt::format("{}: {} pairs of object and view explained", options.scene, tally.pairs);
  for (const auto& [fate, count] : tally.fates) line += fmt::format(", {} {}", count, fate);
  fmt::print("{}; {} reported but not seen, {} missed by {}; verified {}, not confirmed {}\n", line, tally.conservative,
             tally.missed, options.method, tally.pairs - tally.contradicted, tally.contradicted);
  for (const std::string& trouble : tally.trouble) fmt::print("  {}\n", trouble);
}

int explain_many(const ExplainOptions& options, const LoadedScene& loaded, JsonOutput& output) {
  const Scene& scene = loaded.scene;
  catch_interrupts();
  if (scene.objects().empty()) throw InputError(options.scene, "", "has no objects to ask about");
  const CameraPath path = open_path(options.view.path, options.view.camera, loaded, options.common.seed);
  Witnesses witnesses(options, scene);
  Random random(options.common.seed);
  Tally tally;
  const auto pairs = static_cast<std::uint64_t>(options.random);
  Progress progress("pairs", pairs, options.common.quiet);
  for (std::size_t i = 0; i < path.views.size() && !interrupted(); ++i) {
    const std::uint64_t end = pairs * (i + 1) / path.views.size();
    if (tally.pairs >= end) continue;
    witnesses.look(path.views[i]);
    while (tally.pairs < end && !interrupted()) {
      tally.add(witnesses.judge(pick(witnesses, tally.pairs, random)), path.views[i]);
      progress.show(tally.pairs);
    }
  }
  if (!options.common.stdout_taken) print_tally(options, tally);
  output.write({{"schema", "sightline.explain_random/1"},
                {"scene", options.scene},
                {"method", options.method},
                {"samples", options.samples},
                {"pairs", tally.pairs},
                {"fates", tally.fates},
                {"reported_not_seen", tally.conservative},
                {"missed", tally.missed},
                {"not_confirmed", tally.contradicted},
                {"trouble", tally.trouble},
                {"interrupted", interrupted()}});
  if (tally.contradicted > 0) return exit_internal;
  if (tally.broken > 0) return exit_missed;
  return interrupted() ? exit_interrupted : exit_ok;
}

}  // namespace

int run_explain(const ExplainOptions& options) {
  as_usage([&] { (void)find_algorithm(parse_method(options.method).name, Family::culler); });
  if (options.random == 0 && options.object.empty()) throw UsageError("--object or --random is needed");
  JsonOutput output(options.common);
  const LoadedScene loaded = open_scene(options.scene, options.common);
  return options.random > 0 ? explain_many(options, loaded, output) : explain_one(options, loaded, output);
}

}  // namespace sightline::cli
