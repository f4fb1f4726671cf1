#include "sightline/surface/painter_bsp.hpp"

#include <stdexcept>

#include "sightline/index/bsp.hpp"
#include "sightline/raster/polygon_fill.hpp"
#include "sightline/raster/scene_polygons.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

/// The plane in view space, whose axes are orthonormal and whose origin is the eye.
BspPlane in_view(const BspPlane& plane, const ImageMap& map, const glm::dvec3& eye) {
  return {glm::dmat3(map.to_view) * plane.normal, plane.at(eye)};
}

class PainterBsp final : public Renderer {
 public:
  PainterBsp(const Scene& scene, const BspConfig& config, std::uint64_t most_triangles, bool near_to_far)
      : scene_(scene), config_(config), most_triangles_(most_triangles), near_to_far_(near_to_far) {}

  void draw(const View& view, const VisibleSet& visible, Frame& frame, Counters& counters) override {
    if (!built_) build();
    frame.clear(view.width, view.height);
    const ImageMap map(view);
    const glm::dvec4 eye = map.perspective ? glm::dvec4(view.eye, 1.0) : glm::dvec4(-view_direction(view), 0.0);
    counters.triangles_in += polygons_.owners.size();
    walk_bsp(bsp_, eye, near_to_far_ ? BspOrder::near_to_far : BspOrder::far_to_near, [&](std::uint32_t index) {
      ++counters.nodes_visited;
      const std::span<const BspFragment> fragments = bsp_.fragments_of(bsp_.nodes[index]);
      // In a plane the lowest id wins: last of all from far to near, first from near to far.
      for (std::size_t i = 0; i < fragments.size(); ++i) {
        const BspFragment& fragment = fragments[near_to_far_ ? i : fragments.size() - 1 - i];
        if (visible.contains(polygons_.owners[fragment.source].object))
          draw_fragment(map, view.eye, fragment, frame, counters);
      }
    });
  }

 private:
  void build() {
    polygons_ = scene_polygons(scene_, most_triangles_, "painter_bsp");
    try {
      bsp_ = build_bsp(polygons_.polygons, config_);
    } catch (const std::length_error& error) {
      throw InputError(std::string("painter_bsp: ") + error.what());
    }
    polygons_.polygons = {};
    built_ = true;
  }

  void draw_fragment(const ImageMap& map, const glm::dvec3& eye, const BspFragment& fragment, Frame& frame,
                     Counters& counters) {
    corners_.clear();
    bool cut = false;
    for (const BspCorner& corner : bsp_.corners_of(fragment)) {
      corners_.push_back(map.view_point(corner.position));
      cut |= corner.cut != no_cut;
    }
    if (cut) {
      source_.clear();
      for (const glm::dvec3& p : bsp_.polygons[fragment.source]) source_.push_back(map.view_point(p));
      if (!fill_.set(map, source_) || !fill_.narrow(map, corners_)) return;
      for (const BspCorner& corner : bsp_.corners_of(fragment))
        if (corner.cut != no_cut)
          fill_.cut(map, in_view(bsp_.nodes[corner.cut / 2].plane, map, eye), corner.cut % 2 != 0);
    } else if (!fill_.set(map, corners_)) {
      return;
    }
    ++counters.triangles_filled;
    const ScenePolygons::Owner owner = polygons_.owners[fragment.source];
    fill_.fill([&](int x, int y, float depth) {
      const std::size_t at = frame.index(x, y);
      ++counters.pixels_tested;
      if (near_to_far_ && frame.object[at] != no_object) return;
      ++counters.pixels_written;
      frame.depth[at] = depth;
      frame.object[at] = owner.object;
      frame.triangle[at] = owner.triangle;
    });
  }

  const Scene& scene_;
  const BspConfig config_;
  const std::uint64_t most_triangles_;
  const bool near_to_far_;
  bool built_ = false;
  ScenePolygons polygons_;
  Bsp bsp_;
  PolygonFill fill_;
  std::vector<glm::dvec3> corners_, source_;
};

}  // namespace

std::unique_ptr<Renderer> make_painter_bsp(const IndexedScene& scene, ParameterReader& parameters) {
  BspConfig config;
  std::string splitter = "mixed";
  bool near_to_far = false;
  int most_triangles = 2'000'000, most_fragments = 20'000'000;
  parameters.read("splitter", splitter);
  parameters.read("near_to_far", near_to_far);
  parameters.read("candidates", config.candidates, 1, 64);
  parameters.read("most_triangles", most_triangles, 1, 100'000'000);
  parameters.read("most_fragments", most_fragments, 1, 1'000'000'000);
  parameters.finish();
  if (!read_splitter(splitter, config.splitter))
    throw InputError("splitter: '" + splitter + "' is not " + std::string(bsp_splitter_names));
  config.most_fragments = static_cast<std::size_t>(most_fragments);
  return std::make_unique<PainterBsp>(scene.scene, config, static_cast<std::uint64_t>(most_triangles), near_to_far);
}

}  // namespace sightline
