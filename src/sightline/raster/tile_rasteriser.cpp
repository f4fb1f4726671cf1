#include "sightline/raster/tile_rasteriser.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/tile_camera.hpp"
#include "sightline/raster/tile_clip.hpp"

namespace sightline::raster {
namespace {

constexpr std::size_t objects_per_block = 512;

/// An object that may touch a screen tile.
struct BinEntry {
  ObjectId object;
  float near;  // largest nearness
};

bool outside(const Aabb& box, const MeshPlane* planes, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const MeshPlane& p = planes[i];
    const float x = p.nx >= 0 ? box.hi.x : box.lo.x, y = p.ny >= 0 ? box.hi.y : box.lo.y,
                z = p.nz >= 0 ? box.hi.z : box.lo.z;
    if (p.nx * x + p.ny * y + p.nz * z + p.d < 0) return true;
  }
  return false;
}

/// Draws the objects of one screen tile.
class TilePainter {
 public:
  TilePainter(const Scene& scene, std::span<const ClusterMesh> meshes, const TileCamera& camera,
              const TileSettings& settings, ScreenTile& tile, TileStats& stats)
      : scene_(scene),
        meshes_(meshes),
        camera_(camera),
        settings_(settings),
        kernels_(settings.scalar ? scalar_tile_kernels() : simd_tile_kernels()),
        tile_(tile),
        stats_(stats) {}

  void clear(int x0, int y0, int width, int height) {
    tile_.x0 = x0;
    tile_.y0 = y0;
    tile_.width = width;
    tile_.height = height;
    const float before_all = std::numeric_limits<float>::infinity();
    for (int y = 0; y < screen_tile_height; ++y) {
      float* row = tile_.depth + y * screen_tile_stride;
      std::fill(row, row + screen_tile_stride, y < height ? nowhere : before_all);
      std::fill(row + width, row + screen_tile_stride, before_all);
    }
    if (settings_.count_writes) std::fill(std::begin(tile_.writes), std::end(tile_.writes), 0u);
    if (!settings_.hierarchical) return;
    std::fill(std::begin(tile_.farthest), std::end(tile_.farthest), nowhere);
    const bool whole = width == screen_tile_width && height == screen_tile_height;
    std::fill(std::begin(tile_.dirty), std::end(tile_.dirty), whole ? 0u : 0xFFFFFFFFu);
  }

  void draw(std::vector<BinEntry>& entries) {
    if (settings_.hierarchical)
      std::sort(entries.begin(), entries.end(), [](const BinEntry& a, const BinEntry& b) {
        return a.near != b.near ? a.near > b.near : a.object < b.object;
      });
    for (const BinEntry& entry : entries) draw_object(entry.object);
  }

  [[nodiscard]] const std::vector<DrawnCluster>& drawn() const { return drawn_; }

 private:
  void draw_object(ObjectId id) {
    const Object& object = scene_.objects()[id];
    const ClusterMesh& mesh = meshes_[object.mesh];
    const MeshRows rows(camera_, object.transform, mesh.bounds);
    const BoxTransform boxes = rows.box_transform(camera_);
    ++stats_.objects;
    if (settings_.hierarchical &&
        kernels_.hidden(tile_, kernels_.project(&mesh.bounds.lo.x, &mesh.bounds.hi.x, boxes))) {
      ++stats_.objects_hidden;
      return;
    }
    std::array<MeshPlane, 6> planes;
    const std::size_t count =
        rows.planes(camera_, tile_.x0, tile_.y0, tile_.x0 + tile_.width, tile_.y0 + tile_.height, planes.data());
    kept_.resize(mesh.clusters.size() + cluster_padding);
    kept_.resize(kernels_.cull(mesh, planes.data(), count, kept_.data()));
    const MeshTransform transform = camera_.mesh_transform(object.transform);
    const bool mirrored = determinant(object.transform) < 0.0f;
    const DrawFlags flags{settings_.ids, settings_.hierarchical, settings_.count_writes,
                          settings_.cull_back ? (mirrored ? -1 : 1) : 0};
    stats_.clusters += kept_.size();
    if (!settings_.hierarchical) {
      for (const std::uint32_t c : kept_) draw_cluster(id, mesh, mesh.clusters[c], transform, flags);
      return;
    }
    order_.clear();
    for (const std::uint32_t c : kept_) {
      const float low[] = {mesh.low_x[c], mesh.low_y[c], mesh.low_z[c]};
      const float high[] = {mesh.high_x[c], mesh.high_y[c], mesh.high_z[c]};
      const BoxImage image = kernels_.project(low, high, boxes);
      if (kernels_.hidden(tile_, image))
        ++stats_.clusters_hidden;
      else
        order_.push_back({image.whole ? std::numeric_limits<float>::infinity() : image.near, c, image});
    }
    std::sort(order_.begin(), order_.end(), [](const Ordered& a, const Ordered& b) {
      return a.near != b.near ? a.near > b.near : a.cluster < b.cluster;
    });
    for (std::size_t i = 0; i < order_.size(); ++i) {
      if (i > 0 && kernels_.hidden(tile_, order_[i].image))
        ++stats_.clusters_hidden;
      else
        draw_cluster(id, mesh, mesh.clusters[order_[i].cluster], transform, flags);
    }
  }

  void draw_cluster(ObjectId id, const ClusterMesh& mesh, const Cluster& cluster, const MeshTransform& transform,
                    const DrawFlags& flags) {
    stats_.triangles_in += cluster.triangles;
    std::uint32_t number = 0;
    if (flags.ids) {
      number = static_cast<std::uint32_t>(drawn_.size()) << 7;
      assert(drawn_.size() < (1u << 25));
      drawn_.push_back({id, cluster.first_triangle});
      tile_.drawn = drawn_.data();
    }
    const std::size_t v = cluster.vertex_offset, t = cluster.index_offset;
    const std::uint32_t codes = kernels_.transform(mesh.x.data() + v, mesh.y.data() + v, mesh.z.data() + v,
                                                   cluster.vertices, transform, vertices_);
    const std::uint8_t *a = mesh.a.data() + t, *b = mesh.b.data() + t, *c = mesh.c.data() + t;
    if (codes == 0) {
      kernels_.draw(vertices_, a, b, c, cluster.triangles, number, 1, flags, tile_, stats_.work);
      return;
    }
    // One by one: what needs no clipping as it is, the rest clipped into a fan.
    for (std::uint32_t i = 0; i < cluster.triangles; ++i) {
      const std::uint32_t any = vertices_.code[a[i]] | vertices_.code[b[i]] | vertices_.code[c[i]];
      const std::uint32_t every = vertices_.code[a[i]] & vertices_.code[b[i]] & vertices_.code[c[i]];
      if ((every & (before_near | beyond_far)) != 0) continue;
      if (any == 0) {
        std::array<std::uint8_t, 8> one[3]{};
        one[0][0] = a[i];
        one[1][0] = b[i];
        one[2][0] = c[i];
        kernels_.draw(vertices_, one[0].data(), one[1].data(), one[2].data(), 1, number + i, 0, flags, tile_,
                      stats_.work);
        continue;
      }
      const std::size_t corners = clip_triangle(vertices_, a[i], b[i], c[i], transform, clipped_);
      if (corners < 3) continue;
      std::array<std::uint8_t, 16> fan[3]{};
      for (std::size_t k = 0; k + 2 < corners; ++k) {
        fan[1][k] = static_cast<std::uint8_t>(k + 1);
        fan[2][k] = static_cast<std::uint8_t>(k + 2);
      }
      kernels_.draw(clipped_, fan[0].data(), fan[1].data(), fan[2].data(), corners - 2, number + i, 0, flags, tile_,
                    stats_.work);
    }
  }

  struct Ordered {
    float near;
    std::uint32_t cluster;
    BoxImage image;
  };

  const Scene& scene_;
  std::span<const ClusterMesh> meshes_;
  const TileCamera& camera_;
  const TileSettings& settings_;
  const TileKernels& kernels_;
  ScreenTile& tile_;
  TileStats& stats_;
  std::vector<DrawnCluster> drawn_;
  std::vector<std::uint32_t> kept_;
  std::vector<Ordered> order_;
  VertexBuffer vertices_{}, clipped_{};
};

struct Grid {
  int across, down;
  explicit Grid(const View& view)
      : across((view.width + screen_tile_width - 1) / screen_tile_width),
        down((view.height + screen_tile_height - 1) / screen_tile_height) {}
  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(across) * static_cast<std::size_t>(down); }
};

/// Which screen tiles each object may touch: bins[block][tile], blocks of objects in their order.
using Bins = std::vector<std::vector<std::vector<BinEntry>>>;

Bins bin_objects(const Scene& scene, std::span<const ClusterMesh> meshes, const TileCamera& camera, const View& view,
                 std::span<const ObjectId> objects, const TileKernels& kernels) {
  const Grid grid(view);
  Bins bins((objects.size() + objects_per_block - 1) / objects_per_block);
  parallel_blocks(objects.size(), objects_per_block, [&](std::size_t begin, std::size_t end) {
    auto& mine = bins[begin / objects_per_block];
    mine.resize(grid.count());
    for (std::size_t i = begin; i < end; ++i) {
      const Object& object = scene.objects()[objects[i]];
      const ClusterMesh& mesh = meshes[object.mesh];
      if (mesh.clusters.empty()) continue;
      const MeshRows rows(camera, object.transform, mesh.bounds);
      std::array<MeshPlane, 6> planes;
      const std::size_t count = rows.planes(camera, 0, 0, view.width, view.height, planes.data());
      if (outside(mesh.bounds, planes.data(), count)) continue;
      BoxImage box = kernels.project(&mesh.bounds.lo.x, &mesh.bounds.hi.x, rows.box_transform(camera));
      if (box.whole)
        box = {0,
               0,
               static_cast<float>(view.width),
               static_cast<float>(view.height),
               std::numeric_limits<float>::infinity(),
               true};
      const auto tile_of = [](float v, int size, int tiles) {
        return static_cast<int>(
            std::clamp(std::floor(v / static_cast<float>(size)), 0.0f, static_cast<float>(tiles - 1)));
      };
      if (!(box.x1 >= 0) || !(box.y1 >= 0) || !(box.x0 <= static_cast<float>(view.width)) ||
          !(box.y0 <= static_cast<float>(view.height)))
        continue;
      for (int y = tile_of(box.y0, screen_tile_height, grid.down); y <= tile_of(box.y1, screen_tile_height, grid.down);
           ++y)
        for (int x = tile_of(box.x0, screen_tile_width, grid.across);
             x <= tile_of(box.x1, screen_tile_width, grid.across); ++x)
          mine[static_cast<std::size_t>(y * grid.across + x)].push_back({objects[i], box.near});
    }
  });
  return bins;
}

/// Copies a finished screen tile into the image.
void resolve(const ScreenTile& tile, bool perspective, bool ids, const TileSettings& settings, Frame& frame,
             TileStats& stats) {
  for (int y = 0; y < tile.height; ++y) {
    const std::size_t from = static_cast<std::size_t>(y * screen_tile_stride), to = frame.index(tile.x0, tile.y0 + y);
    const float* near = tile.depth + from;
    float* depth = frame.depth.data() + to;
    // The background's nearness is minus infinity; a division would give -0 for it.
    if (perspective)
      for (int x = 0; x < tile.width; ++x)
        depth[x] = near[x] > 0.0f ? 1.0f / near[x] : std::numeric_limits<float>::infinity();
    else
      for (int x = 0; x < tile.width; ++x) depth[x] = -near[x];
    if (settings.count_writes) std::copy_n(tile.writes + from, tile.width, stats.writes.data() + to);
    if (!ids) continue;
    for (std::size_t x = 0; x < static_cast<std::size_t>(tile.width); ++x) {
      const bool covered = near[x] != nowhere;
      const std::uint32_t id = tile.id[from + x];
      frame.object[to + x] = covered ? tile.drawn[id >> 7].object : no_object;
      frame.triangle[to + x] = covered ? tile.drawn[id >> 7].first_triangle + (id & 127) : 0;
    }
  }
}

void add(TileStats& sum, const TileStats& part) {
  sum.objects += part.objects;
  sum.objects_hidden += part.objects_hidden;
  sum.clusters += part.clusters;
  sum.clusters_hidden += part.clusters_hidden;
  sum.triangles_in += part.triangles_in;
  sum.work.triangles += part.work.triangles;
  sum.work.tested += part.work.tested;
  sum.work.written += part.work.written;
  sum.work.tiles_rejected += part.work.tiles_rejected;
  sum.work.tiles_filled += part.work.tiles_filled;
  sum.work.tiles_unchanged += part.work.tiles_unchanged;
}

}  // namespace

TileRasteriser::TileRasteriser(const Scene& scene) : scene_(scene), meshes_(scene.meshes().size()) {
  parallel_blocks(meshes_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) meshes_[i] = make_clusters(scene.meshes()[i]);
  });
}

TileRasteriser::~TileRasteriser() = default;

const char* TileRasteriser::target(bool scalar) {
  return (scalar ? scalar_tile_kernels() : simd_tile_kernels()).target;
}

void TileRasteriser::draw(const View& view, std::span<const ObjectId> objects, const TileSettings& settings,
                          Frame& frame, TileStats& stats) const {
  const TileCamera camera(view);
  const TileKernels& kernels = settings.scalar ? scalar_tile_kernels() : simd_tile_kernels();
  const Bins bins = bin_objects(scene_, meshes_, camera, view, objects, kernels);
  frame.width = view.width;
  frame.height = view.height;
  const auto pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  frame.depth.resize(pixels);
  frame.object.resize(settings.ids ? pixels : 0);
  frame.triangle.resize(settings.ids ? pixels : 0);
  frame.colour.clear();
  frame.stencil.clear();
  if (settings.count_writes) stats.writes.resize(pixels);
  const int fine_across = (view.width + depth_tile - 1) / depth_tile;
  if (settings.hierarchical)
    stats.farthest.resize(static_cast<std::size_t>(fine_across) *
                          static_cast<std::size_t>((view.height + depth_tile - 1) / depth_tile));
  const Grid grid(view);
  std::vector<TileStats> parts(grid.count());
  parallel_blocks(grid.count(), 1, [&](std::size_t begin, std::size_t end) {
    thread_local const std::unique_ptr<ScreenTile> tile = std::make_unique<ScreenTile>();
    for (std::size_t i = begin; i < end; ++i) {
      TilePainter painter(scene_, meshes_, camera, settings, *tile, parts[i]);
      const int x0 = static_cast<int>(i) % grid.across * screen_tile_width;
      const int y0 = static_cast<int>(i) / grid.across * screen_tile_height;
      painter.clear(x0, y0, std::min(screen_tile_width, view.width - x0),
                    std::min(screen_tile_height, view.height - y0));
      std::vector<BinEntry> entries;
      for (const auto& block : bins)
        if (!block.empty()) entries.insert(entries.end(), block[i].begin(), block[i].end());
      painter.draw(entries);
      resolve(*tile, camera.perspective, settings.ids, settings, frame, stats);
      if (!settings.hierarchical) continue;
      for (int y = 0; y < tile->height; y += depth_tile)
        for (int x = 0; x < tile->width; x += depth_tile) {
          float farthest = 0;
          for (int j = y; j < std::min(y + depth_tile, tile->height); ++j)
            for (int k = x; k < std::min(x + depth_tile, tile->width); ++k)
              farthest = std::max(farthest, frame.depth[frame.index(x0 + k, y0 + j)]);
          stats.farthest[static_cast<std::size_t>((y0 + y) / depth_tile * fine_across + (x0 + x) / depth_tile)] =
              farthest;
        }
    }
  });
  for (const TileStats& part : parts) add(stats, part);
}

}  // namespace sightline::raster
