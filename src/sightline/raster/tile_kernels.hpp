// The inner loops of the tile rasteriser, one set for every SIMD target and a scalar one; all give the same bits (no
// fused multiply-add, no reassociation). Internal to raster/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "sightline/raster/cluster_mesh.hpp"

namespace sightline::raster {

inline constexpr int screen_tile_width = 256, screen_tile_height = 128;  // pixels of one unit of work for a thread
inline constexpr int depth_tile = 8;                                     // pixels across and down a tile of the HZB
inline constexpr int tiles_across = screen_tile_width / depth_tile, tiles_down = screen_tile_height / depth_tile;
inline constexpr int screen_tile_stride = screen_tile_width + 16;  // loops may touch pixels right of the last column

/// Nearness is what depth is here: affine in the image and larger when nearer: 1 / distance for perspective views,
/// -distance for orthographic ones.
inline constexpr float nowhere = -std::numeric_limits<float>::infinity();

/// Mesh space to pixels. World points are rounded as transform_point rounds them; then d = (p - eye_high) - eye_low,
/// exact near the eye; then rows * d.
struct MeshTransform {
  float to_world[12];  // columns
  float eye_high[3], eye_low[3];
  float to_x[3], to_y[3], to_w[3];  // pixels times distance, pixels times distance (down), distance
  float centre_x, centre_y;         // pixels
  float near, far;                  // metres
  float guard;  // pixels from the image's centre: corners farther out would lose digits, so edges are cut there
  bool perspective;
};

/// Why a vertex needs the slow path.
enum VertexCode : std::uint32_t { before_near = 1, beyond_far = 2, outside_guard = 4 };

inline constexpr std::size_t vertex_room = cluster_vertices + cluster_padding;
struct alignas(16) ScreenPoint {
  float x, y, near, w;  // pixels, nearness, distance
};
struct alignas(64) VertexBuffer {
  ScreenPoint point[vertex_room];
  float view_x[vertex_room], view_y[vertex_room];
  std::uint32_t code[vertex_room];
};

/// What a triangle id of the image stands for: id >> 7 is an index into a list of these, id & 127 is added to `first`.
struct DrawnCluster {
  std::uint32_t object, first_triangle;
};

/// One screen tile: the on-chip memory. Rows from the top; pixels outside of the image are nearer than anything.
struct alignas(64) ScreenTile {
  float depth[screen_tile_stride * screen_tile_height];           // nearness
  std::uint32_t id[screen_tile_stride * screen_tile_height];      // where depth is not `nowhere`
  std::uint32_t writes[screen_tile_stride * screen_tile_height];  // kept if asked for
  float farthest[tiles_across * tiles_down + 16];  // least nearness of each 8 x 8 tile; a lower bound where dirty
  std::uint32_t dirty[tiles_down];                 // bit per column: `farthest` is to be computed again
  int x0, y0, width, height;                       // the part of the image, pixels
  const DrawnCluster* drawn;                       // list that ids point into
};

struct TileCounts {
  std::uint64_t triangles = 0;        // set up
  std::uint64_t tested = 0;           // fragments: depth tests
  std::uint64_t written = 0;          // depth writes
  std::uint64_t tiles_rejected = 0;   // 8 x 8 tiles of large triangles hidden by `farthest` (reject tests 1 and 2)
  std::uint64_t tiles_filled = 0;     // 8 x 8 tiles of large triangles that were filled
  std::uint64_t tiles_unchanged = 0;  // of those: every fragment was behind `farthest` (reject test 3), so it stays
};

struct DrawFlags {
  bool ids;           // keep ids and counts; otherwise depth alone
  bool hierarchical;  // use and keep `farthest`
  bool count_writes;  // keep ScreenTile::writes (needs ids)
  int cull;           // +1: leave out triangles that are clockwise on the screen, -1: the others, 0: none
};

/// Pixels [x0, x1) x [y0, y1) that a box can touch and the largest nearness in it; all slack included.
struct BoxImage {
  float x0, y0, x1, y1, near;
  bool whole;  // reaches the eye plane: may touch all pixels
};

/// A half space in mesh space: outside where nx x + ny y + nz z + d < 0.
struct MeshPlane {
  float nx, ny, nz, d;
};

/// Mesh space to view rows in one step, for bounds only (slack covers the different rounding).
struct BoxTransform {
  float x[4], y[4], w[4];
  float slack_x, slack_y, slack_w;  // absolute, of each row
  float centre_x, centre_y;
  float near;
  bool perspective;
};

struct TileKernels {
  const char* target;
  /// Transforms `count` vertices (arrays are padded); returns the codes of all, combined by or.
  std::uint32_t (*transform)(const float* x, const float* y, const float* z, std::size_t count, const MeshTransform&,
                             VertexBuffer& out);
  /// Draws triangles whose corners all have code 0. id of triangle i is `id + i * id_step`.
  void (*draw)(const VertexBuffer&, const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c,
               std::size_t count, std::uint32_t id, std::uint32_t id_step, const DrawFlags&, ScreenTile&, TileCounts&);
  /// Indices of the clusters that no plane shuts out; returns how many.
  std::size_t (*cull)(const ClusterMesh&, const MeshPlane* planes, std::size_t plane_count, std::uint32_t* out);
  BoxImage (*project)(const float* low, const float* high, const BoxTransform&);
  /// True if all pixels of the box's rectangle, cut to the tile, hold surfaces nearer than anything in the box.
  bool (*hidden)(ScreenTile&, const BoxImage&);
};

const TileKernels& simd_tile_kernels();
const TileKernels& scalar_tile_kernels();

}  // namespace sightline::raster
