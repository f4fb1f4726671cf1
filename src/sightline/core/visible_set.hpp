// A set of object ids with the order in which they were found.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/scene/scene.hpp"

namespace sightline {

/// Subset of the ids 0 .. universe-1. Insertion is O(1); reset() costs the size of the universe / 64.
class VisibleSet {
 public:
  VisibleSet() = default;
  explicit VisibleSet(std::size_t universe) { reset(universe); }
  /// Every id, ascending.
  static VisibleSet all(std::size_t universe);

  /// Empties the set and sets its universe; keeps its memory.
  void reset(std::size_t universe);
  /// Adds id; does nothing if it is in the set already.
  void insert(ObjectId id) {
    std::uint64_t& word = bits_[id >> 6];
    const std::uint64_t bit = std::uint64_t{1} << (id & 63);
    if ((word & bit) != 0) return;
    word |= bit;
    order_.push_back(id);
  }
  /// Adds ids, none of which may be in the set already, in their order.
  void insert_new(std::span<const ObjectId> ids) {
    for (const ObjectId id : ids) bits_[id >> 6] |= std::uint64_t{1} << (id & 63);
    order_.insert(order_.end(), ids.begin(), ids.end());
  }
  [[nodiscard]] bool contains(ObjectId id) const { return ((bits_[id >> 6] >> (id & 63)) & 1) != 0; }
  [[nodiscard]] std::size_t universe() const { return universe_; }
  [[nodiscard]] std::size_t count() const { return order_.size(); }
  /// True iff every id of the universe is in the set: walks over the whole scene then need no look-up per object.
  [[nodiscard]] bool is_all() const { return count() == universe(); }
  /// Ids in the order of insertion.
  [[nodiscard]] std::span<const ObjectId> order() const { return order_; }
  /// Ids ascending.
  [[nodiscard]] std::vector<ObjectId> sorted() const;
  [[nodiscard]] bool subset_of(const VisibleSet& other) const;

 private:
  std::size_t universe_ = 0;
  std::vector<std::uint64_t> bits_;
  std::vector<ObjectId> order_;
};

/// Ids in either set / in a but not in b; order of a first. Universes must be equal.
VisibleSet set_union(const VisibleSet& a, const VisibleSet& b);
VisibleSet set_difference(const VisibleSet& a, const VisibleSet& b);

}  // namespace sightline
