// What the occlusion cullers share that test an object, draw it if it may be seen, and go on to the next: the objects
// of the view in an order (checklist 21.05, 21.16), and the depth image that fills up (raster/occlusion_buffer.hpp).
#pragma once

#include <span>
#include <vector>

#include "sightline/core/algorithm.hpp"
#include "sightline/raster/box_footprint.hpp"
#include "sightline/raster/occlusion_buffer.hpp"
#include "sightline/scene/occludee_bounds.hpp"

namespace sightline {

/// In which order objects are tested and drawn: front to back (the best), shuffled, or back to front (the worst).
enum class Order { sorted, random, worst };

struct OcclusionStageConfig {
  Order order = Order::sorted;
  double resolution = 0.5;  // depth image pixels per view pixel along each axis, 1/16 to 2
  int triangles = 200000;   // budget of occluder triangles per frame; what does not fit hides nothing
  double min_size = 6;      // pixels of the depth image: objects with a narrower rectangle are not drawn
  bool scalar = false;      // run the one-lane reference loops; the answer is the same
  double tight = 1.0;       // sigma of tight occludee bounds (scene/occludee_bounds), 1 for one box per object
};

/// Reads order, resolution, triangles, min_size, scalar and tight.
void read_stage(ParameterReader& parameters, OcclusionStageConfig& config);

/// A box that an object is asked about, all of it behind the near plane.
struct Occludee {
  Aabb bounds;  // world space
  BoxFootprint footprint;
};

/// An object of the view.
struct StagedObject {
  ObjectId id;
  double distance;  // of its box from the eye (along the view direction for orthographic views), metres
  BoxFootprint footprint;
};

class OcclusionStage {
 public:
  OcclusionStage(const IndexedScene& scene, const OcclusionStageConfig& config);

  /// Starts a view: collects the candidates in the frustum, in order, and empties the depth image.
  void begin(const View& view, const VisibleSet& candidates, Counters& counters);
  [[nodiscard]] std::span<const StagedObject> objects() const { return objects_; }
  /// True if an object may be seen, as `seen` says of what it is given: the object's box alone first and, if that may
  /// be seen, the tight boxes, all those that lie in the image. A box that reaches before the near plane may be seen.
  template <class Seen>
  bool may_be_seen(const StagedObject& object, Seen&& seen) {
    const Occludee whole{scene_.objects()[object.id].bounds, object.footprint};
    if (object.footprint.place == BoxPlace::rectangle && !seen(std::span(&whole, 1))) return false;
    return !project_parts(object.id) || (!parts_.empty() && seen(std::span<const Occludee>(parts_)));
  }
  /// Draws an object if it is opaque, large enough and fits the budget; true if it may have changed the depth image.
  bool draw(const StagedObject& object);
  /// The same in two steps: takes the triangles from the budget; draws what was reserved.
  bool reserve(const StagedObject& object);
  void draw_reserved(const StagedObject& object);
  /// Adds what was drawn.
  void end(Counters& counters) const;
  /// Places the tight bounds where the objects are now; all else is read from the scene in every view.
  void follow_scene();

  [[nodiscard]] const OcclusionBuffer& buffer() const { return buffer_; }
  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] int width() const { return buffer_.width(); }
  [[nodiscard]] int height() const { return buffer_.height(); }
  /// Pixels of the depth image for so many of the view.
  [[nodiscard]] int scaled_pixels(double view_pixels) const {
    return static_cast<int>(view_pixels * config_.resolution * config_.resolution);
  }

 private:
  /// The tight boxes in the image into parts_; false if the object has none or one reaches before the near plane.
  bool project_parts(ObjectId id);
  void collect(const Frustum& frustum, const VisibleSet& candidates, Counters& counters);
  void sort();
  const Scene& scene_;
  const Bvh& bvh_;
  OcclusionStageConfig config_;
  OcclusionBuffer buffer_;
  std::vector<OccluderMesh> meshes_;  // by mesh id; empty where it can never fit the budget
  OccludeeBounds tight_;              // empty without
  BoxProjector projector_;
  std::vector<StagedObject> objects_;
  std::vector<Occludee> parts_;
  std::vector<std::uint32_t> stack_;
  std::int64_t budget_ = 0;
};

}  // namespace sightline
