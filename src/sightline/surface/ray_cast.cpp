#include "sightline/surface/ray_cast.hpp"

#include <algorithm>
#include <atomic>
#include <string>

#include "sightline/index/tracer.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/scene/scene_soup.hpp"

namespace sightline {
namespace {

/// A soup and the structure over it.
struct Traced {
  explicit Traced(TriangleSoup triangles, const TracerKind& kind)
      : soup(std::move(triangles)), tracer(kind.make(soup)) {}
  TriangleSoup soup;
  std::unique_ptr<Tracer> tracer;
};

class RayCast final : public Renderer {
 public:
  RayCast(const Scene& scene, const TracerKind& kind) : scene_(scene), kind_(kind) {}

  void draw(const View& view, const VisibleSet& visible, Frame& frame, Counters& counters) override {
    frame.clear(view.width, view.height);
    prepare_structure(visible);
    counters.triangles_in += traced_->soup.size();
    std::atomic<std::uint64_t> nodes{0}, tests{0};
    constexpr std::size_t rows = 4;
    parallel_blocks(static_cast<std::size_t>(view.height), rows, [&](std::size_t begin, std::size_t end) {
      TraceCounters work;
      for (std::size_t y = begin; y < end; ++y) draw_row(view, static_cast<int>(y), frame, work);
      nodes.fetch_add(work.nodes, std::memory_order_relaxed);
      tests.fetch_add(work.tests, std::memory_order_relaxed);
    });
    counters.nodes_visited += nodes;
    counters.ray_triangle_tests += tests;
    counters.rays += frame.object.size();
  }

 private:
  /// The structure holds the visible objects alone, and is kept as long as those are the same.
  void prepare_structure(const VisibleSet& visible) {
    std::vector<ObjectId> objects = visible.sorted();
    if (traced_ && objects == objects_) return;
    objects_ = std::move(objects);
    traced_ = std::make_unique<Traced>(soup_of(scene_, objects_), kind_);
  }

  void draw_row(const View& view, int y, Frame& frame, TraceCounters& work) const {
    for (int x = 0; x < view.width; ++x) {
      const PixelRay r = pixel_ray(view, x + 0.5, y + 0.5);
      const auto far = static_cast<float>(std::min(r.t_far, static_cast<double>(std::numeric_limits<float>::max())));
      const RayHit hit = traced_->tracer->nearest(
          {glm::vec3(r.origin), static_cast<float>(r.t_near), glm::vec3(r.direction), far}, work);
      if (!hit.found()) continue;
      const std::size_t at = frame.index(x, y);
      const TriangleSoup::Ids ids = traced_->soup.ids(hit.triangle);
      frame.depth[at] = hit.t;  // the direction has unit depth
      frame.object[at] = ids.object;
      frame.triangle[at] = ids.triangle;
    }
  }

  const Scene& scene_;
  const TracerKind& kind_;
  std::vector<ObjectId> objects_;
  std::unique_ptr<Traced> traced_;
};

}  // namespace

std::unique_ptr<Renderer> make_ray_cast(const IndexedScene& scene, ParameterReader& parameters) {
  std::string structure = "bvh8";
  parameters.read("structure", structure);
  parameters.finish();
  const TracerKind* kind = find_tracer(structure);
  if (kind == nullptr) {
    std::string names;
    for (const TracerKind& k : tracer_kinds()) names += (names.empty() ? "" : ", ") + std::string(k.name);
    throw InputError("no structure is called '" + structure + "'; there are " + names);
  }
  return std::make_unique<RayCast>(scene.scene, *kind);
}

}  // namespace sightline
