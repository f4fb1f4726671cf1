#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "explain.hpp"

namespace sightline::cli {
namespace {

constexpr std::size_t covers_shown = 8;

std::string label(const Scene& scene, ObjectId id) {
  const std::string_view name = scene.name(id);
  return name.empty() ? fmt::format("object {}", id) : fmt::format("object {} ({})", id, name);
}

std::string point_text(const glm::dvec3& p) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x, p.y, p.z); }

std::string margin_text(double metres) {
  return metres >= 0.01 ? fmt::format("{:.2f} m", metres) : fmt::format("{:.2e} m", metres);
}

std::string verdict(const Scene& scene, const Judgement& judgement) {
  const Explanation& why = judgement.why;
  const std::string what = label(scene, why.object);
  if (judgement.missed())
    return fmt::format("MISSED: {} is seen, but {} culled it{}", what, judgement.method,
                       judgement.broken_promise() ? "" : ", which it may, as it approximates");
  if (why.fate == Fate::seen) return fmt::format("visible: {} is seen, and {} reports it", what, judgement.method);
  if (judgement.reported)
    return fmt::format("reported but not seen at any sample: {} reports {}", judgement.method, what);
  return fmt::format("culled: {} is not seen, and {} does not report it", what, judgement.method);
}

std::string share(std::uint64_t part, std::uint64_t whole) {
  return fmt::format("{:.1f} %",
                     100.0 * static_cast<double>(part) / static_cast<double>(std::max<std::uint64_t>(whole, 1)));
}

void add_covers(std::string& text, const Scene& scene, const Explanation& why) {
  for (std::size_t i = 0; i < std::min(why.covers.size(), covers_shown); ++i)
    fmt::format_to(std::back_inserter(text), "    {:>7}  {}\n", share(why.covers[i].samples, why.alone_samples),
                   label(scene, why.covers[i].object));
  if (why.covers.size() <= covers_shown) return;
  std::uint64_t rest = 0;
  for (std::size_t i = covers_shown; i < why.covers.size(); ++i) rest += why.covers[i].samples;
  fmt::format_to(std::back_inserter(text), "    {:>7}  {} more\n", share(rest, why.alone_samples),
                 why.covers.size() - covers_shown);
}

void add_witness(std::string& text, const Explanation& why) {
  fmt::format_to(std::back_inserter(text), "  seen through {} of the {} samples that would see it alone\n",
                 why.seen_samples, why.alone_samples);
  if (!why.witness) return;
  const Witness& w = *why.witness;
  fmt::format_to(std::back_inserter(text),
                 "  witness: the ray through ({:.10g}, {:.10g}) of the image, from {} along {}, meets its triangle {} "
                 "at depth {:.6g} m, at {}\n",
                 w.x, w.y, point_text(w.ray.origin), point_text(glm::normalize(w.ray.direction)), w.hit.triangle,
                 w.hit.depth, point_text(w.point));
  if (why.covers.empty()) return;
  text += "  the rest is covered by\n";
}

void add_reason(std::string& text, const Explanation& why) {
  switch (why.fate) {
    case Fate::seen:
      add_witness(text, why);
      break;
    case Fate::outside:
      if (why.plane)
        text += fmt::format("  stage: frustum. {} lies {} beyond the {} plane\n",
                            why.plane->whole_box ? "Its box" : "It (not all of its box)",
                            margin_text(why.plane->margin), why.plane->name);
      else
        text += "  stage: frustum. It lies outside, at a corner: beyond no single plane, and no triangle reaches in\n";
      break;
    case Fate::occluded:
      text += fmt::format("  stage: occlusion. All {} samples that would see it alone are covered{}, by\n",
                          why.alone_samples,
                          why.ties > 0 ? fmt::format(" ({} by surfaces at the same depth)", why.ties) : "");
      break;
    case Fate::between_samples:
      text += "  stage: detail. It is in the frustum, but falls between the samples";
      if (why.box_pixels)
        text += fmt::format(": its box spans {:.3g} x {:.3g} pixels", why.box_pixels->x, why.box_pixels->y);
      text += "\n";
      break;
    case Fate::empty:
      text += "  it has no triangles\n";
      break;
  }
}

Json witness_json(const Witness& w) {
  return {{"pixel", {w.x, w.y}},  {"origin", vector_json(w.ray.origin)}, {"direction", vector_json(w.ray.direction)},
          {"depth", w.hit.depth}, {"triangle", w.hit.triangle},          {"point", vector_json(w.point)}};
}

}  // namespace

std::string explanation_text(const Scene& scene, const View& view, const Judgement& judgement) {
  std::string text = verdict(scene, judgement) + "\n";
  add_reason(text, judgement.why);
  add_covers(text, scene, judgement.why);
  text += fmt::format("  view: {}\n", describe(view));
  text += fmt::format("  verified by rays, {0} x {0} for each pixel\n", judgement.why.samples_per_axis);
  return text;
}

Json explanation_json(const Scene& scene, const View& view, const Judgement& judgement) {
  const Explanation& why = judgement.why;
  Json json{{"schema", "sightline.explain/1"},
            {"object", why.object},
            {"name", scene.name(why.object)},
            {"method", judgement.method},
            {"promise", to_string(judgement.promise)},
            {"reported", judgement.reported},
            {"fate", to_string(why.fate)},
            {"missed", judgement.missed()},
            {"view", describe(view)},
            {"samples", why.samples_per_axis},
            {"seen_samples", why.seen_samples},
            {"alone_samples", why.alone_samples},
            {"ties", why.ties},
            {"witness", why.witness ? witness_json(*why.witness) : Json(nullptr)},
            {"plane", nullptr},
            {"covers", Json::array()},
            {"box_pixels", why.box_pixels ? Json{why.box_pixels->x, why.box_pixels->y} : Json(nullptr)},
            {"verified", why.contradiction.empty()}};
  if (why.plane)
    json["plane"] = {{"name", why.plane->name}, {"margin", why.plane->margin}, {"whole_box", why.plane->whole_box}};
  for (const Cover& cover : why.covers)
    json["covers"].push_back({{"object", cover.object},
                              {"name", scene.name(cover.object)},
                              {"samples", cover.samples},
                              {"share", static_cast<double>(cover.samples) / static_cast<double>(why.alone_samples)}});
  return json;
}

}  // namespace sightline::cli
