// The inner loops of the occlusion buffer, one set for every SIMD target and a scalar one; all give the same bits (no
// fused multiply-add, no reassociation). An occluder is first made into a list of what to draw, then the list is drawn,
// both within a strip of columns, so that strips can be drawn by several threads. Internal to raster/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "sightline/raster/occluder_mesh.hpp"
#include "sightline/raster/occlusion_clip.hpp"

namespace sightline::raster {

inline constexpr int tile_size = 4;                        // pixels across and down
inline constexpr int tile_pixels = tile_size * tile_size;  // lane l of a tile is pixel (l % 4, l / 4)

/// Nearness is what depth is here: affine in the image and larger when nearer. 1 / distance for perspective views,
/// -distance for orthographic ones (distance along the view direction, metres).
inline constexpr float nothing_near = -std::numeric_limits<float>::infinity();

/// A cache line, so that vectors lie in one.
struct alignas(64) TilePixels {
  float lane[tile_pixels];
};

/// The buffer: what is hidden so far.
struct Tiles {
  int width = 0, height = 0;       // pixels
  int across = 0, down = 0;        // tiles
  std::vector<TilePixels> hidden;  // everything of lesser nearness is hidden in the whole pixel square
  std::vector<float> farthest;     // per tile: least `hidden` of its pixels within the image

  /// Empties all.
  void resize(int new_width, int new_height);
  /// `hidden` of a pixel.
  [[nodiscard]] float at(int x, int y) const {
    const int tile = y / tile_size * across + x / tile_size, lane = y % tile_size * tile_size + x % tile_size;
    return hidden[static_cast<std::size_t>(tile)].lane[lane];
  }
};

/// Mesh space to pixels. A vertex p maps to d = (p - eye_high) - eye_low, exact near the eye; then rows * d.
struct ScreenTransform {
  float eye_high[3], eye_low[3];
  float to_x[3], to_y[3], to_w[3];  // view-space x and y times the pixels per unit, and the distance; y grows downwards
  float centre_x, centre_y;         // pixels
  bool perspective;
};

/// How far things are moved to the safe side: pixels for coverage; nearness by a share of itself and by a constant.
struct Margins {
  float square;  // half the side of the part of a pixel that counts: 0.5, or 0 if its centre alone does
  float pixels;
  float nearness_share, nearness;
};

/// An occluder's mesh in a view.
struct MeshView {
  ScreenTransform screen;
  Margins margins;
  bool mirrored = false;  // the transform turns front faces into back faces
  /// Some vertices may lie too near or too far aside for floats: each is checked, and triangles with one that does are
  /// clipped in double precision, with margins of their own.
  bool partial = false;
  float nearest = 0;  // distance from which on floats are right
  float guard = 0;    // pixels from the image's centre
  float error_w = 0;  // orthographic: largest sum of the products' sizes that still rounds to within the margin
  float aside = 0;    // pixels from the image beyond which nothing matters
  ClipTransform clip;
  Margins clip_margins;
};

/// One side of one component of an occluder, or the part of it that shares margins.
struct Run {
  std::uint32_t first_triangle, last_triangle, first_edge, last_edge;  // [first, last)
  Margins margins;
  float nearest;            // nearness that nothing of the surface exceeds
  int first_row, last_row;  // tiles, inclusive
  int first_column, last_column;
};

/// Runs [first, last) of a list that make up a surface.
struct Surface {
  float nearest;
  std::uint32_t first, last;
};

/// What to draw: corners of triangles and ends of contour edges in pixels, as arrays that are reused.
struct DrawList {
  std::vector<float> x[3], y[3], near[3];
  std::vector<float> edge_x[2], edge_y[2], edge_near[2];
  std::vector<Run> runs;
  std::vector<Surface> surfaces;
  std::uint32_t triangles = 0, edges = 0;

  void clear();
  /// Room for so many more.
  void reserve(std::size_t more_triangles, std::size_t more_edges);
};

/// Room for one occluder's projected vertices, facing and lists; grows, is reused.
struct Scratch {
  std::vector<float> x, y, near, facing;
  std::vector<std::int32_t> code, front, back, edges, clipped;
};

/// What a triangle that covers pixels of a tile in part is there: its nearness in a pixel is from max(plane, least) to
/// min(plane + rise, most).
struct alignas(64) Piece {
  float plane[tile_pixels];  // +inf where it does not touch the pixel
  float least, rise, most;
  std::uint32_t covered;  // bit per lane: it covers the centre
  std::uint32_t next;     // place of the tile's next one
};
/// The least and the largest nearness of all contour edges in each pixel of a tile; +inf and -inf where there are none.
struct alignas(64) Rim {
  float low[tile_pixels], high[tile_pixels];
};
inline constexpr std::uint32_t no_piece = 0xFFFFFFFFu;  // and no rim

/// What the current surface has done to a tile of a strip.
struct Place {
  std::uint32_t rim = no_piece, piece = no_piece;  // the latter the first one; no piece without a rim
  /// Bit per lane: the centre is covered by a triangle that shares the pixel with others and that is nearer than what
  /// is hidden already; in tiles without a contour all that may be.
  std::uint16_t covered = 0;
  std::uint8_t listed = 0;  // is in `touched`
};

/// Columns of tiles that one thread draws, and all that it writes but for the buffer itself. The layer gathers the
/// pixels that several triangles of the current surface share, pieces do so in tiles with a contour; between surfaces
/// all from the layer to `touched` is empty.
struct Strip {
  struct Touched {
    std::uint32_t tile, place;
  };
  int first_column = 0, last_column = -1;  // inclusive
  // By place, that is by tile of the strip.
  std::vector<TilePixels> layer;  // least nearness of the surface's triangles that touch the pixel; else +inf
  std::vector<Place> places;
  std::vector<Piece> pieces;
  std::vector<Rim> rims;
  std::size_t used_pieces = 0, used_rims = 0;
  std::vector<Touched> touched;  // tiles to commit after this surface
  DrawList list;
  Scratch scratch;
  std::uint64_t triangles_filled = 0, tiles_filled = 0;

  /// Columns first .. last of the tiles, with nothing drawn.
  void begin(const Tiles& tiles, int first, int last);
  [[nodiscard]] std::size_t place(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(last_column - first_column + 1) +
           static_cast<std::size_t>(column - first_column);
  }
};

/// World space to pixels for queries, with what is needed to bound the error of the floats.
struct QueryView {
  ScreenTransform screen;
  float pixels_per_unit;  // the larger one of x and y
  float near_plane;
  float eye_low_sum;
  float square;  // as in Margins
  int width, height;
};

/// What a query is about: pixels [x0, x1) x [y0, y1) and a nearness that nothing of the box exceeds.
enum class Verdict : std::int32_t { hidden, seen, ask };
struct Rectangles {
  static constexpr std::size_t capacity = 64;
  std::int32_t x0[capacity], y0[capacity], x1[capacity], y1[capacity];
  float near[capacity];
  /// A pixel that the box certainly touches (or -1), and a nearness that all of the box exceeds: where the buffer hides
  /// less, the box is seen for sure.
  std::int32_t centre_x[capacity], centre_y[capacity];
  float far[capacity];
  Verdict verdict[capacity];  // ask: the rectangle decides
};

/// A convex occludee: pixels inside all edges (e(x, y) = a x + b y + c >= -1 at the centre of every pixel that it
/// touches), no nearer than any of the planes (nearness at most a x + b y + c anywhere in the pixel at x, y) and
/// `near`.
struct Hull {
  int edges = 0, planes = 0;
  float edge_a[6], edge_b[6], edge_c[6];
  float plane_a[3], plane_b[3], plane_c[3];
  int x0, y0, x1, y1;
  float near;
};

struct Kernels {
  const char* target;
  /// Draws what of a mesh lies in the strip.
  void (*draw)(const OccluderMesh&, const MeshView&, Tiles&, Strip&);
  /// True if every pixel of [x0, x1) x [y0, y1) hides what is of nearness `near`. The rectangle lies within the image.
  bool (*hides)(const Tiles&, int x0, int y0, int x1, int y1, float near);
  bool (*hides_hull)(const Tiles&, const Hull&);
  /// Projects up to Rectangles::capacity boxes, of which `boxes` has six floats each (lo, hi).
  void (*project_boxes)(const QueryView&, const float* boxes, std::size_t count, Rectangles&);
};

/// The best target of this machine, and the scalar reference.
const Kernels& simd_kernels();
const Kernels& scalar_kernels();

}  // namespace sightline::raster
