// What a culler says of a view, as tests ask it.
#pragma once

#include <string>

#include "sightline/registry.hpp"

namespace sightline {

struct Answer {
  VisibleSet visible;
  Counters counters;
};

inline Answer ask(Culler& culler, const View& view, const VisibleSet& candidates) {
  Answer answer;
  culler.cull(view, candidates, answer.visible, answer.counters);
  return answer;
}

/// All objects of the scene, by a culler without a past.
inline Answer ask(const std::string& method, const IndexedScene& indexed, const View& view) {
  return ask(*make_culler(method, indexed), view, VisibleSet::all(indexed.scene.objects().size()));
}

}  // namespace sightline
