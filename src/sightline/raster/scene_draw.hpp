// Scenes through the pipeline: objects become programs with flat shading. What the reports and pictures of the pipeline
// are made of; renderers of the registry are elsewhere.
#pragma once

#include <span>

#include "sightline/raster/fragment_tests.hpp"
#include "sightline/scene/view.hpp"

namespace sightline::raster {

/// What the fragment program does besides the colour; decides whether the tests may come early (4.05, E6).
enum class ProgramKind { plain, discards, writes_depth };

struct SceneDraw {
  State state;
  ProgramKind kind = ProgramKind::plain;
  /// Rounds of arithmetic per fragment: an expensive program.
  int cost = 0;
  float alpha = 1.0f;
};

/// Draws the objects in the given order; adds to `counts`. Colours are the same for the same triangle in every draw,
/// and so are positions bit by bit, as a depth pre-pass needs.
void draw_scene(const Scene& scene, const View& view, std::span<const ObjectId> objects, const SceneDraw& what,
                Target& target, DrawCounts& counts);

/// Objects by the distance of their boxes' centres along the view direction, nearest first.
std::vector<ObjectId> front_to_back(const Scene& scene, const View& view);

}  // namespace sightline::raster
