// The interface of every method that decides which objects cannot be seen.
#pragma once

#include "sightline/core/counters.hpp"
#include "sightline/core/promise.hpp"
#include "sightline/core/visible_set.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

/// A culler is made for one scene and keeps what it learns from frame to frame in itself; not a callback walk, so that
/// a temporal algorithm may stop and go on. One object serves one thread at a time.
class Culler {
 public:
  virtual ~Culler() = default;
  Culler() = default;
  Culler(const Culler&) = delete;
  Culler& operator=(const Culler&) = delete;

  /// Puts into `visible` (cleared first) those of the candidates that may be seen from `view`, in the order in which
  /// they were found; always a subset of the candidates. Adds to `counters`. The view must pass check_view.
  virtual void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) = 0;

  /// What it promises, given what its row does: less where its parameters trade the promise for speed.
  [[nodiscard]] virtual Promise promise(Promise of_row) const { return of_row; }

  /// Brings what it keeps of objects' places up to date, after Scene::move_objects and refit(IndexedScene). False if it
  /// cannot: then it is to be made anew before the next frame.
  [[nodiscard]] virtual bool follow_scene() { return false; }

  /// Forgets everything learnt from earlier frames.
  virtual void reset() {}
};

}  // namespace sightline
