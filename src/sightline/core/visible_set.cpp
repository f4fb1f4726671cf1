#include "sightline/core/visible_set.hpp"

#include <algorithm>
#include <cassert>

namespace sightline {

VisibleSet VisibleSet::all(std::size_t universe) {
  VisibleSet set(universe);
  for (std::size_t id = 0; id < universe; ++id) set.insert(static_cast<ObjectId>(id));
  return set;
}

void VisibleSet::reset(std::size_t universe) {
  universe_ = universe;
  bits_.assign((universe + 63) / 64, 0);
  order_.clear();
}

std::vector<ObjectId> VisibleSet::sorted() const {
  std::vector<ObjectId> ids(order_);
  std::sort(ids.begin(), ids.end());
  return ids;
}

bool VisibleSet::subset_of(const VisibleSet& other) const {
  assert(universe_ == other.universe_);
  for (std::size_t i = 0; i < bits_.size(); ++i)
    if ((bits_[i] & ~other.bits_[i]) != 0) return false;
  return true;
}

VisibleSet set_union(const VisibleSet& a, const VisibleSet& b) {
  assert(a.universe() == b.universe());
  VisibleSet result = a;
  for (const ObjectId id : b.order()) result.insert(id);
  return result;
}

VisibleSet set_difference(const VisibleSet& a, const VisibleSet& b) {
  assert(a.universe() == b.universe());
  VisibleSet result(a.universe());
  for (const ObjectId id : a.order())
    if (!b.contains(id)) result.insert(id);
  return result;
}

}  // namespace sightline
