// The interface of every method that decides which triangles turn their backs (the back-face family, checklist 17-19).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/core/counters.hpp"
#include "sightline/core/visible_set.hpp"
#include "sightline/geometry/bit_range.hpp"
#include "sightline/scene/solid.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

/// Triangles of objects: for each object a run of bits, one for each triangle of its mesh in the culler's own order.
class FaceSet {
 public:
  struct Part {
    ObjectId object;
    std::uint32_t triangles;
    std::size_t first_word;
  };

  void clear() {
    parts_.clear();
    words_.clear();
  }
  /// Adds an object with no triangle in the set, or all; returns its words, valid until the next add.
  std::span<std::uint64_t> add(ObjectId object, std::size_t triangles, bool all);

  [[nodiscard]] std::span<const Part> parts() const { return parts_; }
  [[nodiscard]] bool contains(const Part& part, std::size_t place) const {
    return ((words_[part.first_word + (place >> 6)] >> (place & 63)) & 1) != 0;
  }
  /// Triangles in the set; of one object; of all.
  [[nodiscard]] std::size_t count(const Part& part) const;
  [[nodiscard]] std::size_t count() const;

 private:
  std::vector<Part> parts_;
  std::vector<std::uint64_t> words_;
};

/// A face culler is made for one scene; one object serves one thread at a time.
class FaceCuller {
 public:
  virtual ~FaceCuller() = default;
  FaceCuller() = default;
  FaceCuller(const FaceCuller&) = delete;
  FaceCuller& operator=(const FaceCuller&) = delete;

  /// Puts into `kept` (cleared first) one part for each of `objects`, in their order. Contains every triangle that
  /// faces the eye and of which a part lies within the image (between the four side planes of the view). Only opaque
  /// objects of solid meshes lose triangles; all others are kept whole. Adds to `counters`.
  virtual void cull(const View& view, const VisibleSet& objects, FaceSet& kept, Counters& counters) = 0;

  /// The triangle at each place of this culler's order, for the bits of a part; empty if it is the mesh's own.
  [[nodiscard]] virtual std::span<const std::uint32_t> order(MeshId mesh) const = 0;

  /// Whether the mesh can lose triangles at all.
  [[nodiscard]] virtual Solidity solidity(MeshId mesh) const = 0;

  /// Bytes of what the culler keeps beside the scene.
  [[nodiscard]] virtual std::size_t bytes() const = 0;
};

}  // namespace sightline
