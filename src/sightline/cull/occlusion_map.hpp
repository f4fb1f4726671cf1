// Occlusion queries in batches that do not overlap, after a cheap test against an occupancy map (Staneker, Bartz,
// Meissner 2003; checklist 22.11, 22.12): an object with an unoccupied pixel is visible without a query, and objects
// that do not overlap on the screen cannot hide each other, so their queries need not wait for each other.
// Promise: conservative-continuous.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sightline/core/algorithm.hpp"
#include "sightline/raster/box_footprint.hpp"

namespace sightline {

/// Splits a sequence of rectangles into batches: those of one batch do not overlap each other, nor any earlier one of
/// a later batch, so that testing a batch before drawing any of it loses nothing. Returns for each rectangle the number
/// of its batch, from 0 on; at most `longest` rectangles a batch.
std::vector<std::uint32_t> overlap_free_batches(std::span<const BoxFootprint> rectangles, std::uint32_t longest);

/// Parameters: those of the stage (cull/occlusion_stage.hpp); `batch`: most queries of a batch, 1 to 4096; `map`: off
/// sends every object to a query, for comparison.
std::unique_ptr<Culler> make_occlusion_map(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
