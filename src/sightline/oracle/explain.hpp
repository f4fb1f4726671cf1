// Why is one object seen or not: a witness ray, the plane of the frustum that it lies outside of, or the occluders that
// cover it, sample by sample. Promise: what is said was checked by a second run of the rays over a part of the scene
// (checklist 20.01, 21.01); `contradiction` tells if that failed.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/oracle/oracle.hpp"

namespace sightline {

enum class Fate {
  seen,             // through at least one sample
  outside,          // no part of its surface lies in the view frustum
  occluded,         // every sample through which it would be seen alone sees an occluder instead
  between_samples,  // in the frustum, but no sample hits it: smaller than a pixel, or seen edge-on
  empty             // has no triangles
};

std::string_view to_string(Fate fate);

/// A ray that sees the object: the sample of all that see it that lies nearest to their middle.
struct Witness {
  double x = 0.0, y = 0.0;  // in pixels from the top left corner of the image
  PixelRay ray;
  SurfaceHit hit;
  glm::dvec3 point{0.0};  // of the hit, world space
};

/// The plane of the view frustum that the whole object lies beyond.
struct OutsidePlane {
  std::string_view name;   // "left", "right", "bottom", "top", "near" or "far"
  double margin = 0.0;     // metres from the plane to the nearest point of the object (or of its box)
  bool whole_box = false;  // its box lies beyond the plane, which a box test finds; else only its vertices do
};

/// An object that covers some of the samples through which the explained one would be seen.
struct Cover {
  ObjectId object = no_object;
  std::uint64_t samples = 0;
};

struct Explanation {
  ObjectId object = no_object;
  Fate fate = Fate::empty;
  int samples_per_axis = 1;
  std::uint64_t seen_samples = 0;   // samples that see it
  std::uint64_t alone_samples = 0;  // samples that would see it if it stood alone
  /// Fate::seen.
  std::optional<Witness> witness;
  /// Fate::outside; absent if it lies outside of all planes together but of none alone.
  std::optional<OutsidePlane> plane;
  /// What covers it (also partly, where it is seen), most samples first, then by id.
  std::vector<Cover> covers;
  /// Of the covered samples, those where the cover is as near as the object itself, up to the error of a depth.
  std::uint64_t ties = 0;
  /// Pixels that its box spans on the image, width and height; absent where the box reaches the near plane or it is
  /// empty.
  std::optional<glm::dvec2> box_pixels;
  /// For each sample of `area`, row by row: does the object alone cover it? For pictures.
  SampleRect area;
  std::vector<bool> alone;
  /// Empty if the second look confirmed all of the above; else what it found.
  std::string contradiction;
};

/// Explains what the samples of `view` (n x n for each pixel) see of object `id` of `scene`, of which `oracle` must be
/// made. `truth` must be oracle.look(view, n). The view must pass check_view.
Explanation explain(const Scene& scene, const Oracle& oracle, const Truth& truth, const View& view, ObjectId id);

}  // namespace sightline
