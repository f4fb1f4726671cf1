// CHC++: coherent hierarchical culling revisited (Mattausch, Bittner and Wimmer 2008; checklist 22.13-22.19, 22.22,
// 22.23, 23, 24). Every feature has a switch.
#pragma once

#include <memory>

#include "gl/method.hpp"
#include "gl/multiquery.hpp"
#include "gl/tight_bounds.hpp"
#include "sightline/core/parameters.hpp"

namespace sightline::gl {

struct ChcppConfig {
  bool deterministic = true;  // answers are waited for in a fixed order; off: taken as they come
  int batch = 0;              // previously hidden nodes that are asked about together; 0: all there are at the time
  bool multiqueries = true;   // several hidden nodes share a query
  MultiqueryConfig multiquery{};
  bool measured = true;  // p(t) is learnt during the walk, from the paper's curve on; off: the curve
  int assumed = 10;      // a visible leaf is not asked about for 1 .. assumed frames; 0: asked every frame
  bool random = true;    // the first such interval is drawn at random, so that not all leaves ask at once
  bool adapt = true;     // longer intervals for leaves that are cheaper to draw than to query
  int query_cost = 400;  // triangles that are drawn in the time of a query
  TightBoundsConfig tight{};
  int open = 1;       // levels that a node which came into sight is opened at once
  int threshold = 1;  // samples from which on a node counts as seen; above 1: approximate
  int seed = 1;
};

std::unique_ptr<Method> make_chcpp(SceneDrawing& drawing, const ChcppConfig& config);
std::unique_ptr<Method> make_chcpp(SceneDrawing& drawing, ParameterReader& parameters);

}  // namespace sightline::gl
