// The pipeline as stages of which the slowest sets the pace (checklist 4.01, 4.02): application, geometry, fill and
// bus. What a frame costs in each follows from counted work and from unit costs measured on this machine.
#pragma once

#include <optional>
#include <string_view>

#include "sightline/scene/scene.hpp"
#include "sightline/scene/view.hpp"

namespace sightline::cli {

/// Milliseconds for each unit of work of the software renderer `zbuffer`, and of moving memory.
struct UnitCosts {
  double per_triangle = 0;  // transform, clip and set-up; no pixel is filled
  double per_pixel = 0;     // depth test and write
  double per_byte = 0;      // from memory to memory
};

/// Measures each unit by itself, the median of several runs; takes some 100 ms.
UnitCosts measure_unit_costs();

/// Work of a frame.
struct FrameWork {
  double application_ms = 0;     // culling, as measured
  double triangles = 0;          // submitted
  std::optional<double> pixels;  // depth tests; absent where nobody counted
  double bytes = 0;              // vertices and indices submitted
};

struct StageCosts {
  double application_ms = 0, geometry_ms = 0, bus_ms = 0;
  std::optional<double> fill_ms;
  /// The slowest: the throughput of a pipeline is that of its slowest stage.
  std::string_view limiting;
  double limiting_ms = 0;
};

StageCosts stage_costs(const FrameWork& work, const UnitCosts& units);

}  // namespace sightline::cli
