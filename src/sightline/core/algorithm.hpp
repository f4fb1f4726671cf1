// A row of the registry: what an algorithm is called, what it promises, where it comes from, how it is made.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "sightline/core/culler.hpp"
#include "sightline/core/face_culler.hpp"
#include "sightline/core/parameters.hpp"
#include "sightline/core/promise.hpp"
#include "sightline/core/renderer.hpp"
#include "sightline/index/bvh.hpp"

namespace sightline {

enum class Family { culler, renderer, face_culler };

std::string_view to_string(Family family);

/// A scene with the index over its objects' bounds: what a maker gets. The scene must outlive it.
struct IndexedScene {
  const Scene& scene;
  Bvh bvh;
};
IndexedScene index_scene(const Scene& scene);

/// After Scene::move_objects: the index holds the objects where they are now. Its shape stays, so after much movement a
/// new one is faster. O(objects).
void refit(IndexedScene& scene);

/// World bounds of bvh.items, in their order: what lies below a node stands side by side.
std::vector<Aabb> bounds_in_tree_order(const IndexedScene& scene);

/// Exactly one of the makers is set, as `family` says. Makers throw InputError on a bad parameter.
struct Algorithm {
  std::string_view name;
  Family family;
  Promise promise;
  std::string_view summary;    // one line
  std::string_view paper;      // author and year, or "-"
  std::string_view checklist;  // item numbers of the checklist
  std::unique_ptr<Culler> (*make_culler)(const IndexedScene&, ParameterReader&) = nullptr;
  std::unique_ptr<Renderer> (*make_renderer)(const IndexedScene&, ParameterReader&) = nullptr;
  std::unique_ptr<FaceCuller> (*make_face_culler)(const IndexedScene&, ParameterReader&) = nullptr;
};

}  // namespace sightline
