// Pictures of sightline structures, as SVG: bars of figures, cells of a quadtree beside those of a kd-tree, an octree.
#pragma once

#include <string>
#include <vector>

#include "sightline/index/triangle_soup.hpp"

namespace sightline::cli {

/// One chart: a bar for each name; a value that is not finite has none. Values are drawn on a logarithmic scale if they
/// span more than a factor of a hundred.
struct Bars {
  std::string title, unit;
  std::vector<double> values;
};

std::string draw_bars(const std::vector<std::string>& names, const std::vector<Bars>& charts);

/// The scene from above (x to the right, z down): quadtree and kd-tree, split until a cell holds at most one object, at
/// most `generations` and twice as many deep (checklist 14.09, 14.10). `letters`: what each object is called in the
/// leaves, empty for a scene too full for that.
std::string draw_cells(const TriangleSoup& soup, int generations, const std::string& letters);

/// The octree figure (checklist 14.11): (a) the root cube, (b) its children, (c) theirs, seen from the side above;
/// cells that hold triangles are filled, empty ones are not drawn.
std::string draw_octree(const TriangleSoup& soup);

/// The plane scene of the slides: a rod, a box and a circle (objects 0, 1, 2) in the square from 0 to 16.
TriangleSoup plane_example();

}  // namespace sightline::cli
