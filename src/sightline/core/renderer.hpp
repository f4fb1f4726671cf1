// The interface of every visible-surface algorithm.
#pragma once

#include "sightline/core/counters.hpp"
#include "sightline/core/frame.hpp"
#include "sightline/core/visible_set.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

class Renderer {
 public:
  virtual ~Renderer() = default;
  Renderer() = default;
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Draws the objects of `visible` as seen from `view` into `frame` (cleared first): depth, object and triangle id of
  /// the nearest surface at every pixel centre between near and far plane. Adds to `counters`.
  virtual void draw(const View& view, const VisibleSet& visible, Frame& frame, Counters& counters) = 0;
};

}  // namespace sightline
