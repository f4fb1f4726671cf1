// Plots of equal size in a grid of roads, about as deep as wide: what cities and plants are made of.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace sightline {

struct PlotGrid {
  std::uint32_t count = 1, columns = 1, lines = 1, objects = 0;
  glm::dvec2 plot, pitch;  // metres in x and z, without and with a road

  /// For so many objects, with about `per_plot` of them on each plot.
  PlotGrid(std::uint32_t all_objects, std::uint32_t per_plot, const glm::dvec2& plot_size, double road)
      : objects(all_objects), plot(plot_size), pitch(plot_size + road) {
    count = std::max(1u, (objects + per_plot / 2) / per_plot);
    columns = static_cast<std::uint32_t>(std::ceil(std::sqrt(count * pitch.y / pitch.x)));
    lines = (count + columns - 1) / columns;
  }
  /// From the first to the last road's middle; the grid is centred on the origin.
  [[nodiscard]] glm::dvec2 size() const { return glm::dvec2(columns, lines) * pitch; }
  /// The lowest corner of plot i.
  [[nodiscard]] glm::dvec2 corner(std::uint32_t i) const {
    const std::uint32_t line = i / columns;
    return glm::dvec2(i - line * columns, line) * pitch + 0.5 * (pitch - plot) - 0.5 * size();
  }
  /// How many objects there are once plot i is full.
  [[nodiscard]] std::uint32_t until(std::uint32_t i) const {
    return static_cast<std::uint32_t>(std::uint64_t{objects} * (i + 1) / count);
  }
};

}  // namespace sightline
