#include "sightline/cull/detail.hpp"

#include <cmath>
#include <optional>
#include <string>

#include "sightline/geometry/frustum_boxes.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/scene/object_hulls.hpp"
#include "sightline/scene/screen_area.hpp"

namespace sightline {
namespace {

enum class Estimate { slide, ellipse, silhouette };

struct DetailConfig {
  double pixels = 1.0;  // objects of a lesser area are dropped, pixels of the view
  double hysteresis =
      0.0;              // share: what is drawn stays until below pixels * (1 - h), what is not until pixels * (1 + h)
  double motion = 0.0;  // the threshold grows by this share for each pixel that the object moves over the image
  Estimate estimate = Estimate::ellipse;
};

class Detail final : public Culler {
 public:
  Detail(const Scene& scene, const DetailConfig& config)
      : scene_(scene),
        config_(config),
        boxes_(scene.object_bounds()),
        reach_(reach(scene.bounds())),
        ids_(boxes_.count + 64),
        spheres_(scene.objects().size()) {
    if (config.estimate == Estimate::silhouette) return;
    const std::vector<ConvexHull> hulls = mesh_hulls(scene);
    parallel_blocks(spheres_.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Object& object = scene.objects()[i];
        const ConvexHull hull = placed_hull(hulls[object.mesh], object.transform);
        spheres_[i] = smallest_sphere(hull.vertices);
        if (spheres_[i].radius >= 0.0f) spheres_[i].radius += hull.slack;
      }
    });
  }

  void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) override {
    visible.reset(candidates.universe());
    drawn_.resize(spheres_.size(), State::unknown);
    const bool all = candidates.is_all();
    now_ = view_projection(view);
    const std::size_t found = boxes_in_frustum(boxes_, view_frustum(view, reach_), ids_.data());
    counters.boxes_tested += boxes_.count;
    for (std::size_t i = 0; i < found; ++i) {
      const ObjectId id = ids_[i];
      if (!all && !candidates.contains(id)) continue;
      ++counters.queries;
      const bool draw = area(view, id) >= threshold(view, id);
      drawn_[id] = draw ? State::drawn : State::dropped;
      if (draw) visible.insert(id);
    }
    before_ = now_;
  }

  void reset() override {
    drawn_.clear();
    before_.reset();
  }

 private:
  enum class State : std::uint8_t { unknown, drawn, dropped };

  [[nodiscard]] double area(const View& view, ObjectId id) const {
    if (config_.estimate == Estimate::slide) return slide_area(view, spheres_[id]);
    if (config_.estimate == Estimate::ellipse) return ellipse_area(view, spheres_[id]);
    const Aabb& box = scene_.objects()[id].bounds;
    glm::vec3 corners[8];
    for (int i = 0; i < 8; ++i) corners[i] = box.corner(i);
    return silhouette_area(view, corners);
  }

  /// The faster an object crosses the image, the less of it is missed (26.02).
  [[nodiscard]] double threshold(const View& view, ObjectId id) const {
    double pixels = config_.pixels;
    if (config_.motion > 0.0 && before_) pixels *= 1.0 + config_.motion * moved(view, id);
    if (drawn_[id] == State::drawn) pixels *= 1.0 - config_.hysteresis;
    if (drawn_[id] == State::dropped) pixels *= 1.0 + config_.hysteresis;
    return pixels;
  }

  /// Pixels between where the object's centre is in the image and where it was in the last one; at most the image's
  /// width.
  [[nodiscard]] double moved(const View& view, ObjectId id) const {
    const glm::dvec3 centre(scene_.objects()[id].bounds.centre());
    const glm::dvec4 a = now_ * glm::dvec4(centre, 1.0), b = *before_ * glm::dvec4(centre, 1.0);
    if (!(a.w > 0.0 && b.w > 0.0)) return view.width;
    const glm::dvec2 step = (glm::dvec2(a) / a.w - glm::dvec2(b) / b.w) * 0.5 * glm::dvec2(view.width, view.height);
    return std::min(glm::length(step), static_cast<double>(view.width));
  }

  const Scene& scene_;
  DetailConfig config_;
  BoxArrays boxes_;
  double reach_;
  std::vector<ObjectId> ids_;
  std::vector<Sphere> spheres_;
  std::vector<State> drawn_;
  glm::dmat4 now_{1.0};               // view projection
  std::optional<glm::dmat4> before_;  // that of the last frame
};

}  // namespace

std::unique_ptr<Culler> make_detail(const IndexedScene& scene, ParameterReader& parameters) {
  DetailConfig config;
  std::string estimate = "ellipse";
  parameters.read("pixels", config.pixels, 0.0, 1e9);
  parameters.read("hysteresis", config.hysteresis, 0.0, 0.99);
  parameters.read("motion", config.motion, 0.0, 1e6);
  parameters.read("estimate", estimate);
  parameters.finish();
  if (estimate == "slide")
    config.estimate = Estimate::slide;
  else if (estimate == "silhouette")
    config.estimate = Estimate::silhouette;
  else if (estimate != "ellipse")
    throw InputError("", "detail: estimate", "must be slide, ellipse or silhouette");
  return std::make_unique<Detail>(scene.scene, config);
}

}  // namespace sightline
