// The inner loops of the occlusion buffer, one set for every SIMD target and a scalar one; all give the same bits (no
// fused multiply-add, no reassociation). Internal to raster/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "sightline/raster/occluder_mesh.hpp"

namespace sightline::raster {

inline constexpr int tile_size = 4;                        // pixels across and down
inline constexpr int tile_pixels = tile_size * tile_size;  // lane l of a tile is pixel (l % 4, l / 4)

/// Nearness is what depth is here: affine in the image and larger when nearer. 1 / distance for perspective views,
/// -distance for orthographic ones (distance along the view direction, metres).
inline constexpr float nothing_near = -std::numeric_limits<float>::infinity();

/// The buffer: what is hidden so far, and the layer in which the current occluder gathers the pixels that several of
/// its triangles share.
struct Tiles {
  int width = 0, height = 0;  // pixels
  int across = 0, down = 0;   // tiles
  std::vector<float> hidden;  // per pixel: everything of lesser nearness is hidden in the whole pixel square
  std::vector<float> layer;   // per pixel: least nearness of the triangles of this occluder that touch it; else +inf
  std::vector<std::uint16_t> covered;  // per tile, bit per lane: the centre is covered by one of those triangles
  std::vector<std::uint16_t> contour;  // per tile, bit per lane: a contour edge of this occluder touches the pixel
  std::vector<std::uint8_t> listed;    // per tile: is in `touched`
  std::vector<std::uint32_t> touched;  // tiles to commit after this occluder
  std::vector<float> farthest;         // per tile: least `hidden` of its pixels within the image

  void resize(int new_width, int new_height);
};

/// Mesh space to pixels. A vertex p maps to d = (p - eye_high) - eye_low, exact near the eye; then rows * d.
struct ScreenTransform {
  float eye_high[3], eye_low[3];
  float to_x[3], to_y[3], to_w[3];  // view-space x and y times the pixels per unit, and the distance; y grows downwards
  float centre_x, centre_y;         // pixels
  bool perspective;
};

/// A projected corner: pixels, nearness.
struct ScreenPoint {
  float x, y, near;
};

/// How far things are moved to the safe side: pixels for coverage; nearness by a share of itself and by a constant.
struct Margins {
  float pixels;
  float nearness_share, nearness;
};

struct FillCounts {
  std::uint64_t triangles = 0, tiles = 0, contour_edges = 0;
};

/// Room for one occluder's projected vertices, facing and lists; grows, is reused.
struct Scratch {
  std::vector<float> x, y, near, facing;
  std::vector<std::int32_t> list, edge_list;
};

struct Kernels {
  const char* target;
  /// Draws and commits a whole mesh that lies in front of the near plane and within the guard band. `mirrored`: the
  /// transform turns front faces into back faces.
  void (*draw_mesh)(const OccluderMesh&, const ScreenTransform&, bool mirrored, const Margins&, Tiles&, Scratch&,
                    FillCounts&);
  /// Draws one triangle / marks one contour edge of an occluder that needed clipping. Corners within the guard band.
  void (*fill_triangle)(const ScreenPoint*, const Margins&, Tiles&, FillCounts&);
  void (*mark_contour)(const ScreenPoint&, const ScreenPoint&, const Margins&, Tiles&, FillCounts&);
  /// Ends an occluder: what its layer proves goes into `hidden`.
  void (*commit)(Tiles&);
  /// Recomputes `farthest` of all tiles.
  void (*reduce)(Tiles&);
  /// True if every pixel of [x0, x1) x [y0, y1) hides what is of nearness `near`. The rectangle lies within the image.
  bool (*hides)(const Tiles&, int x0, int y0, int x1, int y1, float near);
};

/// The best target of this machine, and the scalar reference.
const Kernels& simd_kernels();
const Kernels& scalar_kernels();

}  // namespace sightline::raster
