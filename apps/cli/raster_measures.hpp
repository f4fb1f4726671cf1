// The measurements behind `sightline raster-report`, each as one JSON object (checklist 4, 5, 6, 27.06-27.08, 27.10).
#pragma once


#include "json.hpp"
#include "sightline/core/frame.hpp"
#include "sightline/scene/view.hpp"

namespace sightline::cli {


/// Depth writes per covered pixel of the plain and of the hierarchical z-buffer, and how long each took (5.05). The
/// frames keep their write counts.
Json measure_overdraw(const Scene& scene, const View& view, Frame& plain, Frame& hierarchical);

/// Depth complexity by its five definitions, each counted by its own means (a: rays of the oracle, which count surfaces
/// at one depth once; b: fragments; c: blended layers in the stencil; d: fragments behind the finished image; e:
/// z-tests), and z-tests, z-writes and colour writes for three orders (6.01-6.07, E9).
Json measure_complexity(const Scene& scene, const View& view);

/// Colour writes for n triangles over a pixel in random order, simulated in the pipeline, beside H_n, ln n + 0.5 and
/// ln n + 0.577 (6.08-6.10, E10).
Json measure_harmonic(std::uint64_t seed);

/// How the tiles of a depth image compress (5.14, E7), as means and a histogram.
Json measure_compression(const View& view, const Frame& frame);

/// Bytes on the bus without and with each feature of the two-level z-buffer (5.16).
Json measure_traffic(const Scene& scene, const View& view);

/// B = width * height * depth complexity * words * 4 * frames per second, with every factor (5.15, E8).
Json measure_bandwidth(const View& view, double depth_complexity);

/// Fragment program runs and times: early tests off, on, with a depth pre-pass, per order; z alone against z and colour
/// and with the hierarchy (4.06, 4.07, 4.10).
Json measure_early_z(const Scene& scene, const View& view);

/// Distance at which two planes can no longer be told apart, predicted and drawn, per depth format (3.15-3.17).
Json measure_fighting(const View& view);

/// Just noticeable differences of depth as a share of the distance: of eyes and of depth buffers (1.21).
Json measure_just_noticeable(const View& view);

}  // namespace sightline::cli
