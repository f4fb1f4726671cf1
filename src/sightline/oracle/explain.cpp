#include "sightline/oracle/explain.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <span>

namespace sightline {
namespace {

constexpr float never = std::numeric_limits<float>::infinity();

/// Half-space in double precision, without slack: inside iff dot(normal, p) + offset >= 0.
struct ExactPlane {
  std::string_view name;
  glm::dvec3 normal;
  double offset;

  [[nodiscard]] double distance(const glm::dvec3& p) const { return glm::dot(normal, p) + offset; }
};

/// From the view itself rather than from its matrix, so that they are independent of what the cullers test.
std::vector<ExactPlane> planes_of(const View& view) {
  const glm::dmat3 axes = glm::mat3_cast(view.orientation);
  const glm::dvec3 right = axes[0], up = axes[1], ahead = -axes[2];
  const double aspect = static_cast<double>(view.width) / view.height;
  std::vector<ExactPlane> planes;
  const auto add = [&](std::string_view name, const glm::dvec3& normal, const glm::dvec3& point) {
    planes.push_back({name, normal, -glm::dot(normal, point)});
  };
  if (view.projection == Projection::perspective) {
    const double y = std::tan(0.5 * view.fov_y), x = y * aspect;
    add("left", glm::normalize(right + x * ahead), view.eye);
    add("right", glm::normalize(-right + x * ahead), view.eye);
    add("bottom", glm::normalize(up + y * ahead), view.eye);
    add("top", glm::normalize(-up + y * ahead), view.eye);
  } else {
    const double y = 0.5 * view.span_y, x = y * aspect;
    add("left", right, view.eye - x * right);
    add("right", -right, view.eye + x * right);
    add("bottom", up, view.eye - y * up);
    add("top", -up, view.eye + y * up);
  }
  add("near", ahead, view.eye + view.near * ahead);
  if (std::isfinite(view.far)) add("far", -ahead, view.eye + view.far * ahead);
  return planes;
}

/// True if some of the triangle lies inside of all planes (Sutherland and Hodgman 1974).
bool reaches_inside(const std::array<glm::dvec3, 3>& triangle, std::span<const ExactPlane> planes) {
  std::vector<glm::dvec3> polygon(triangle.begin(), triangle.end()), cut;
  for (const ExactPlane& plane : planes) {
    cut.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double da = plane.distance(a), db = plane.distance(b);
      if (da >= 0.0) cut.push_back(a);
      if ((da >= 0.0) != (db >= 0.0)) cut.push_back(a + (b - a) * (da / (da - db)));
    }
    if (cut.empty()) return false;
    polygon.swap(cut);
  }
  return true;
}

/// Where the object stands, for one view.
class Placement {
 public:
  Placement(const Scene& scene, const View& view, ObjectId id)
      : mesh_(scene.mesh_of(id)), object_(scene.objects()[id]), view_(view), planes_(planes_of(view)) {}

  [[nodiscard]] glm::dvec3 vertex(std::uint32_t index) const {
    return glm::dvec3(transform_point(object_.transform, mesh_.positions[index]));
  }

  [[nodiscard]] bool in_frustum() const {
    for (const glm::uvec3& t : mesh_.triangles)
      if (reaches_inside({vertex(t.x), vertex(t.y), vertex(t.z)}, planes_)) return true;
    return false;
  }

  /// The plane that it lies farthest beyond: by its box if there is one, else by its vertices.
  [[nodiscard]] std::optional<OutsidePlane> plane() const {
    std::optional<OutsidePlane> best;
    for (const bool whole_box : {true, false}) {
      for (const ExactPlane& plane : planes_) {
        const double margin = -highest(plane, whole_box);
        if (margin > 0.0 && (!best || margin > best->margin)) best = OutsidePlane{plane.name, margin, whole_box};
      }
      if (best) break;
    }
    return best;
  }

  /// The samples that the box may cover, and its size in pixels; all samples if it reaches the near plane.
  [[nodiscard]] SampleRect area(int n, std::optional<glm::dvec2>& pixels) const {
    const SampleRect all{0, 0, view_.width * n, view_.height * n};
    const glm::dmat4 matrix = view_projection(view_);
    const glm::dvec3 ahead = view_direction(view_);
    glm::dvec2 lo(std::numeric_limits<double>::max()), hi(-lo);
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 corner(object_.bounds.corner(i));
      if (glm::dot(ahead, corner - view_.eye) < view_.near) return all;
      const glm::dvec4 clip = matrix * glm::dvec4(corner, 1.0);
      const glm::dvec2 at((0.5 + 0.5 * clip.x / clip.w) * view_.width, (0.5 - 0.5 * clip.y / clip.w) * view_.height);
      lo = glm::min(lo, at);
      hi = glm::max(hi, at);
    }
    pixels = hi - lo;
    const auto whole = [n](double at, int most) {  // two pixels more, for the rounding of rays
      return static_cast<int>(std::clamp(at * n, -1.0, static_cast<double>(most) + 1.0));
    };
    return {std::max(0, whole(lo.x - 2.0, all.x1)), std::max(0, whole(lo.y - 2.0, all.y1)),
            std::min(all.x1, whole(hi.x + 3.0, all.x1)), std::min(all.y1, whole(hi.y + 3.0, all.y1))};
  }

  /// Metres between a point and the plane of a triangle, or infinity if the point lies outside of the triangle's box by
  /// more than `slack`.
  [[nodiscard]] double distance_to(std::uint32_t triangle, const glm::dvec3& point, double slack) const {
    const glm::uvec3 t = mesh_.triangles[triangle];
    const glm::dvec3 a = vertex(t.x), b = vertex(t.y), c = vertex(t.z);
    const glm::dvec3 lo = glm::min(glm::min(a, b), c) - slack, hi = glm::max(glm::max(a, b), c) + slack;
    for (int axis = 0; axis < 3; ++axis)
      if (point[axis] < lo[axis] || point[axis] > hi[axis]) return std::numeric_limits<double>::infinity();
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const double length = glm::length(cross);
    return length > 0.0 ? std::abs(glm::dot(cross, point - a)) / length : 0.0;
  }

 private:
  /// The largest signed distance to the plane over the box or the vertices.
  [[nodiscard]] double highest(const ExactPlane& plane, bool whole_box) const {
    double most = -std::numeric_limits<double>::infinity();
    if (whole_box) {
      for (int i = 0; i < 8; ++i) most = std::max(most, plane.distance(glm::dvec3(object_.bounds.corner(i))));
    } else {
      for (std::uint32_t i = 0; i < mesh_.positions.size(); ++i) most = std::max(most, plane.distance(vertex(i)));
    }
    return most;
  }

  const Mesh& mesh_;
  const Object& object_;
  const View& view_;
  std::vector<ExactPlane> planes_;
};

/// What a sample says of the object.
struct Sample {
  float alone = never;  // depth of the object if it stood alone
  SurfaceHit seen;      // the object's surface, if the sample sees it
  SurfaceHit cover;     // what stands before it, if it would be seen alone and is not seen
  [[nodiscard]] bool is_seen() const { return seen.object != no_object; }
};

class Explainer {
 public:
  Explainer(const Scene& scene, const Oracle& oracle, const Truth& truth, const View& view, ObjectId id)
      : scene_(scene), oracle_(oracle), view_(view), place_(scene, view, id), only_(scene.objects().size()) {
    only_.insert(id);
    answer_.object = id;
    answer_.samples_per_axis = truth.samples_per_axis;
    answer_.seen_samples = truth.samples[id];
  }

  Explanation answer() {
    if (scene_.mesh_of(answer_.object).triangles.empty()) return answer_;
    answer_.area = place_.area(n(), answer_.box_pixels);
    look_at_samples();
    count();
    answer_.fate = fate();
    if (answer_.fate == Fate::seen) find_witness();
    if (answer_.fate == Fate::outside) answer_.plane = place_.plane();
    verify();
    return answer_;
  }

 private:
  [[nodiscard]] int n() const { return answer_.samples_per_axis; }
  [[nodiscard]] std::size_t width() const { return static_cast<std::size_t>(answer_.area.x1 - answer_.area.x0); }
  Sample& sample_at(int x, int y) {
    return samples_[static_cast<std::size_t>(y - answer_.area.y0) * width() +
                    static_cast<std::size_t>(x - answer_.area.x0)];
  }
  /// Depths that differ by no more are the same to the rays.
  [[nodiscard]] double tolerance(double depth) const {
    const double reaching = static_cast<double>(reach(scene_.bounds())) + glm::length(view_.eye);
    return 4.0 * depth_error * (depth + reaching);
  }

  void look_at_samples() {
    const SampleRect& area = answer_.area;
    if (area.empty()) return;
    samples_.resize(width() * static_cast<std::size_t>(area.y1 - area.y0));
    alone_.emplace(scene_, only_);
    alone_->trace(view_, n(), area, [&](int x, int y, std::span<const SurfaceHit> hits) {
      if (!hits.empty()) sample_at(x, y).alone = hits.front().depth;
    });
    oracle_.trace(view_, n(), area, [&](int x, int y, std::span<const SurfaceHit> hits) {
      Sample& sample = sample_at(x, y);
      for (const SurfaceHit& hit : hits) {
        if (hit.object == answer_.object) {
          sample.seen = hit;
          return;
        }
        // What ends the ray before the object; of surfaces at the same depth rays see either.
        const double gap = static_cast<double>(hit.depth) - static_cast<double>(sample.alone);
        const double near_enough = tolerance(sample.alone);
        if (gap <= near_enough && (scene_.objects()[hit.object].opaque || gap >= -near_enough)) sample.cover = hit;
      }
    });
  }

  void count() {
    std::map<ObjectId, std::uint64_t> covers;
    answer_.alone.resize(samples_.size());
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const Sample& sample = samples_[i];
      seen_in_area_ += sample.is_seen() ? 1 : 0;
      answer_.alone[i] = sample.alone < never;
      if (sample.alone == never) continue;
      ++answer_.alone_samples;
      if (sample.is_seen()) continue;
      if (sample.cover.object == no_object) {
        ++unexplained_;
        continue;
      }
      ++covers[sample.cover.object];
      if (std::abs(sample.cover.depth - sample.alone) <= tolerance(sample.alone)) ++answer_.ties;
    }
    for (const auto& [id, samples] : covers) answer_.covers.push_back({id, samples});
    std::stable_sort(answer_.covers.begin(), answer_.covers.end(),
                     [](const Cover& a, const Cover& b) { return a.samples > b.samples; });
  }

  [[nodiscard]] Fate fate() const {
    if (answer_.seen_samples > 0) return Fate::seen;
    if (answer_.alone_samples > 0) return Fate::occluded;
    return place_.in_frustum() ? Fate::between_samples : Fate::outside;
  }

  void find_witness() {
    const auto x_of = [&](std::size_t i) { return static_cast<double>(i % width()); };
    const auto y_of = [&](std::size_t i) { return static_cast<double>(i / width()); };
    double sum_x = 0.0, sum_y = 0.0, count = 0.0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      if (!samples_[i].is_seen()) continue;
      sum_x += x_of(i);
      sum_y += y_of(i);
      count += 1.0;
    }
    std::size_t best = samples_.size();
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      if (!samples_[i].is_seen()) continue;
      const double distance = std::hypot(x_of(i) - sum_x / count, y_of(i) - sum_y / count);
      if (distance >= nearest) continue;
      nearest = distance;
      best = i;
    }
    if (best == samples_.size()) return;
    Witness witness;
    witness.x = (answer_.area.x0 + x_of(best) + 0.5) / n();
    witness.y = (answer_.area.y0 + y_of(best) + 0.5) / n();
    witness.ray = pixel_ray(view_, witness.x, witness.y);
    witness.hit = samples_[best].seen;
    witness.point = witness.ray.origin + static_cast<double>(witness.hit.depth) * witness.ray.direction;
    answer_.witness = witness;
  }

  void expect(bool holds, const char* otherwise) {
    if (!holds && answer_.contradiction.empty()) answer_.contradiction = otherwise;
  }

  /// A second look, at parts of the scene.
  void verify() {
    expect(seen_in_area_ == answer_.seen_samples, "samples outside of the object's box see it");
    expect(unexplained_ == 0, "a sample would see it alone, does not see it, and nothing stands before it");
    if (!alone_) alone_.emplace(scene_, only_);
    expect(alone_->look(view_, n()).samples[answer_.object] == answer_.alone_samples,
           "alone it is seen by samples outside of its box");
    switch (answer_.fate) {
      case Fate::seen:
        verify_witness();
        break;
      case Fate::outside:
        expect(answer_.alone_samples == 0, "it is outside of the frustum and yet hit by a sample");
        break;
      case Fate::occluded:
        verify_occluders();
        break;
      case Fate::between_samples:
      case Fate::empty:
        break;
    }
  }

  void verify_witness() {
    expect(answer_.witness.has_value(), "no sample of its box sees it");
    if (!answer_.witness) return;
    const Witness& witness = *answer_.witness;
    const double slack = tolerance(witness.hit.depth);
    expect(place_.distance_to(witness.hit.triangle, witness.point, slack) <= slack,
           "the witness does not end on the triangle that it names");
    expect(answer_.alone_samples >= answer_.seen_samples, "alone it is seen by fewer samples than among the others");
  }

  /// The occluders that were named must hide it without the rest of the scene.
  void verify_occluders() {
    VisibleSet few = only_;
    for (const Cover& cover : answer_.covers) few.insert(cover.object);
    const Oracle reduced(scene_, few);
    std::atomic<bool> hidden{true};
    reduced.trace(view_, n(), answer_.area, [&](int x, int y, std::span<const SurfaceHit> hits) {
      const Sample& sample = sample_at(x, y);
      for (const SurfaceHit& hit : hits) {
        // Of two surfaces at the same depth rays see either; that is counted as a tie, not as a contradiction.
        const bool tie = std::abs(sample.cover.depth - hit.depth) <= tolerance(hit.depth);
        if (hit.object == answer_.object && !tie) hidden = false;
      }
    });
    expect(hidden, "the occluders named do not hide it by themselves");
  }

  const Scene& scene_;
  const Oracle& oracle_;
  const View& view_;
  Placement place_;
  VisibleSet only_;
  std::optional<Oracle> alone_;
  Explanation answer_;
  std::vector<Sample> samples_;  // of answer_.area, row by row
  std::uint64_t seen_in_area_ = 0, unexplained_ = 0;
};

}  // namespace

std::string_view to_string(Fate fate) {
  switch (fate) {
    case Fate::seen:
      return "seen";
    case Fate::outside:
      return "outside";
    case Fate::occluded:
      return "occluded";
    case Fate::between_samples:
      return "between samples";
    case Fate::empty:
      return "empty";
  }
  return "unknown";
}

Explanation explain(const Scene& scene, const Oracle& oracle, const Truth& truth, const View& view, ObjectId id) {
  assert(id < scene.objects().size() && truth.samples.size() == scene.objects().size());
  return Explainer(scene, oracle, truth, view, id).answer();
}

}  // namespace sightline
