// What all generators share: parts are declared once and placed many times; their tessellation is chosen at the end,
// when it is known how often each is used, so that the instanced total comes out as asked.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/generate/shapes.hpp"

namespace sightline {

using Part = std::uint32_t;

class Layout {
 public:
  explicit Layout(const GenerateConfig& config) : config_(config) {}

  /// A mesh whose shape is the same at every tessellation.
  Part part(std::string_view name, Mesh mesh);
  /// A mesh made for a tessellation: 0 is the coarsest, 1 natural, and d > 1 has about d^2 times the triangles of 1
  /// or fewer.
  /// Calls `make` at once for 1, and again when the total is known.
  Part part(std::string_view name, std::function<Mesh(double detail)> make);

  /// Places a part; named "<part> <n>" with n counting the uses of the part.
  ObjectId place(Part part, const Affine& transform, bool opaque = true);

  [[nodiscard]] std::uint32_t placed() const { return static_cast<std::uint32_t>(places_.size()); }
  /// Objects that are still to be placed.
  [[nodiscard]] std::uint32_t left() const { return config_.objects > placed() ? config_.objects - placed() : 0; }
  /// Forgets all but the first `count` objects.
  void keep_first(std::uint32_t count);
  /// World bounds of a placed object at natural tessellation, not rounded outwards.
  [[nodiscard]] Aabb bounds(ObjectId id) const;

  std::vector<Cell> cells;
  std::vector<Portal> portals;

  /// Chooses the tessellation and builds the scene; unused parts are dropped.
  Scene build();

 private:
  struct PartInfo {
    std::string name;
    std::function<Mesh(double)> make;  // empty: `natural` at every tessellation
    Mesh natural;
    Aabb bounds;
    std::uint32_t uses = 0;
  };
  struct Place {
    Part part;
    std::uint32_t number;
    bool opaque;
    Affine transform;
  };
  [[nodiscard]] double triangle_factor() const;
  [[nodiscard]] Mesh tessellate(const PartInfo& info, double factor) const;

  GenerateConfig config_;
  std::vector<PartInfo> parts_;
  std::vector<Place> places_;
};

/// Scales, then turns about the vertical axis (in full turns, counter-clockwise seen from above), then moves.
Affine place_at(const glm::dvec3& position, double turns = 0.0, const glm::dvec3& scale = glm::dvec3(1.0));

/// `base` scaled by the tessellation and rounded, at least `least`.
int scaled(int base, double detail, int least);

}  // namespace sightline
