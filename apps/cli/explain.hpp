// An explanation for people: what the culler said beside what the rays say, as text, JSON and a picture.
#pragma once

#include <string>

#include "json_output.hpp"
#include "picture.hpp"
#include "sightline/core/algorithm.hpp"
#include "sightline/oracle/explain.hpp"

namespace sightline::cli {

/// What a culler made of an object, beside the truth.
struct Judgement {
  std::string method;
  Promise promise = Promise::exact;
  bool reported = false;
  Explanation why;

  [[nodiscard]] bool missed() const { return !reported && why.fate == Fate::seen; }
  [[nodiscard]] bool broken_promise() const { return missed() && promise != Promise::approximate; }
};

/// Several lines; the first one is the verdict.
std::string explanation_text(const Scene& scene, const View& view, const Judgement& judgement);

/// Schema "sightline.explain/1".
Json explanation_json(const Scene& scene, const View& view, const Judgement& judgement);

/// The view, shaded; what is seen of the object green, its outline magenta, its occluders tinted (the foremost
/// strongest), and a bar at the edge of the image behind which it lies.
Picture explanation_picture(const Scene& scene, const View& view, const Frame& frame, const Explanation& why);

}  // namespace sightline::cli
