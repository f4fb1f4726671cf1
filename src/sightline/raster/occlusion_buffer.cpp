#include "sightline/raster/occlusion_buffer.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <numeric>

#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/occlusion_hull.hpp"
#include "sightline/raster/occlusion_kernels.hpp"
#include "sightline/raster/occlusion_projection.hpp"
#include "sightline/raster/raw_occluder.hpp"

namespace sightline {

using raster::Kernels;
using raster::MeshView;
using raster::Rectangles;
using raster::Strip;
using raster::ViewTransform;

namespace {

static_assert(sizeof(Aabb) == 6 * sizeof(float), "boxes are read as six floats");

const float* floats(const Aabb* boxes) { return &boxes->lo.x; }

/// An occluder to be drawn: the rectangle around its box and a nearness that it does not exceed, infinite if it may lie
/// before the near plane.
struct Waiting {
  float near;
  std::uint32_t index;
  int x0, y0, x1, y1;
};

}  // namespace

struct OcclusionBuffer::State {
  const Kernels* kernels;
  raster::Tiles tiles;
  ViewTransform view;
  raster::QueryView query{};
  OcclusionCounts counts;
  std::vector<Strip> strips{1};
  std::size_t used_strips = 0;
  std::vector<Waiting> waiting;
  std::vector<float> load, open;    // see cut_strips
  std::vector<std::uint8_t> drawn;  // by strip and place in `waiting`
  RawOccluder raw;

  [[nodiscard]] bool hidden_rectangle(const Rectangles& r, std::size_t i) const {
    return kernels->hides(tiles, r.x0[i], r.y0[i], r.x1[i], r.y1[i], r.near[i]);
  }

  [[nodiscard]] bool hidden_outline(const Rectangles& r, std::size_t i, const Aabb& box,
                                    const raster::LocalView& local) const {
    raster::Hull hull;
    hull.x0 = r.x0[i];
    hull.y0 = r.y0[i];
    hull.x1 = r.x1[i];
    hull.y1 = r.y1[i];
    hull.near = r.near[i];
    raster::outline(local, box, hull);
    return kernels->hides_hull(tiles, hull);
  }

  [[nodiscard]] bool seen(const Rectangles& r, std::size_t i, const Aabb& box, bool outlines) const {
    if (r.verdict[i] != raster::Verdict::ask) return r.verdict[i] == raster::Verdict::seen;
    if (r.centre_x[i] >= 0 && r.centre_y[i] >= 0 && tiles.at(r.centre_x[i], r.centre_y[i]) < r.far[i]) return true;
    if (hidden_rectangle(r, i)) return false;
    return !outlines || !hidden_outline(r, i, box, view.local);
  }

  [[nodiscard]] bool seen(const Aabb& box, bool outlines) const {
    Rectangles r;
    kernels->project_boxes(query, floats(&box), 1, r);
    return seen(r, 0, box, outlines);
  }

  /// What a rectangle in real coordinates and a nearness, both not rounded yet, say.
  [[nodiscard]] Rectangles rectangle(const raster::Footprint& f) const {
    Rectangles r;
    r.verdict[0] = raster::Verdict::ask;
    if (f.farthest < view.near * (1.0 - 1e-6) && view.perspective) r.verdict[0] = raster::Verdict::hidden;
    if (view.perspective && !(f.nearest > view.near) && r.verdict[0] == raster::Verdict::ask)
      r.verdict[0] = raster::Verdict::seen;
    if (r.verdict[0] != raster::Verdict::ask) return r;
    const double margin = view.square - 0.5 + raster::base_margin;
    const auto pixel = [](double v, int pixels) {
      return static_cast<std::int32_t>(std::clamp(std::floor(v), 0.0, static_cast<double>(pixels)));
    };
    r.x0[0] = pixel(f.x0 - margin, tiles.width);
    r.y0[0] = pixel(f.y0 - margin, tiles.height);
    r.x1[0] = pixel(f.x1 + margin + 1, tiles.width);
    r.y1[0] = pixel(f.y1 + margin + 1, tiles.height);
    if (r.x0[0] >= r.x1[0] || r.y0[0] >= r.y1[0]) r.verdict[0] = raster::Verdict::hidden;
    const double near = view.perspective ? 1.0 / f.nearest : -f.nearest;
    r.near[0] = static_cast<float>(near + std::abs(near) * 0x1p-20);
    return r;
  }

  [[nodiscard]] bool seen(const raster::Footprint& f) const {
    const Rectangles r = rectangle(f);
    if (r.verdict[0] != raster::Verdict::ask) return r.verdict[0] == raster::Verdict::seen;
    return !hidden_rectangle(r, 0);
  }

  void count(const OccluderMesh& mesh) {
    ++counts.occluders;
    counts.occluder_triangles += mesh.triangle_count;
  }
  void collect(const Strip& strip) {
    counts.triangles_filled += strip.triangles_filled;
    counts.tiles_filled += strip.tiles_filled;
  }

  /// Fills `waiting` with what may lie in the image, the near ones first.
  void order(std::span<const OccluderInstance> occluders) {
    waiting.clear();
    std::array<Aabb, Rectangles::capacity> boxes;
    Rectangles r;
    for (std::size_t first = 0; first < occluders.size(); first += boxes.size()) {
      const std::size_t here = std::min(boxes.size(), occluders.size() - first);
      for (std::size_t i = 0; i < here; ++i) {
        const OccluderInstance& occluder = occluders[first + i];
        boxes[i] = occluder.mesh->triangle_count > 0 ? world_bounds(occluder.mesh->bounds, occluder.transform) : Aabb();
      }
      kernels->project_boxes(query, floats(boxes.data()), here, r);
      for (std::size_t i = 0; i < here; ++i)
        if (const auto at = static_cast<std::uint32_t>(first + i); r.verdict[i] == raster::Verdict::ask)
          waiting.push_back({r.near[i], at, r.x0[i], r.y0[i], r.x1[i], r.y1[i]});
        else if (r.verdict[i] == raster::Verdict::seen)
          waiting.push_back({std::numeric_limits<float>::infinity(), at, 0, 0, tiles.width, tiles.height});
    }
    std::sort(waiting.begin(), waiting.end(), [](const Waiting& a, const Waiting& b) {
      return a.near != b.near ? a.near > b.near : a.index < b.index;
    });
  }

  static Aabb world_bounds(const Aabb& box, const Affine& transform) {
    Aabb bounds;
    for (int i = 0; i < 8; ++i) bounds.extend(transform_point(transform, box.corner(i)));
    return bounds;
  }

  /// Cuts the columns into so many strips of about the same work, fewer if there are not enough columns. The work is
  /// guessed from the rectangles: a triangle of an occluder costs about as much as three tiles, and what lies behind
  /// rectangles that fill a column costs nothing there.
  void cut_strips(std::span<const OccluderInstance> occluders, std::size_t wanted) {
    load.assign(static_cast<std::size_t>(tiles.across), 0.0f);
    open.assign(load.size(), 1.0f);  // share of the column that is not covered yet
    for (std::size_t i = 0; i < waiting.size() && wanted > 1; ++i) {
      const Waiting& w = waiting[i];
      const int first = w.x0 / raster::tile_size, last = (w.x1 - 1) / raster::tile_size;
      const auto rows = static_cast<float>((w.y1 - w.y0) / raster::tile_size + 1);
      const auto triangles = static_cast<float>(occluders[w.index].mesh->triangle_count);
      const float each = 3.0f * triangles / static_cast<float>(last - first + 1) + rows;
      const float covers = std::isfinite(w.near) ? rows / static_cast<float>(tiles.down) : 0.0f;
      for (int column = first; column <= last; ++column) {
        const auto c = static_cast<std::size_t>(column);
        load[c] += each * open[c];
        open[c] = std::max(0.0f, open[c] - covers);
      }
    }
    std::partial_sum(load.begin(), load.end(), load.begin());
    if (strips.size() < wanted) strips.resize(wanted);
    used_strips = 0;
    for (int first = 0, end = 0; first < tiles.across; first = end) {
      const bool last = used_strips + 1 == wanted;
      const float goal = load.back() * static_cast<float>(used_strips + 1) / static_cast<float>(wanted);
      for (end = first + 1; end < tiles.across && (last || load[static_cast<std::size_t>(end)] <= goal);) ++end;
      strips[used_strips++].begin(tiles, first, end - 1);
    }
  }

  /// Draws what of the waiting ones lies in a strip.
  void draw_strip(std::span<const OccluderInstance> occluders, std::size_t s) {
    Strip& strip = strips[s];
    const int left = strip.first_column * raster::tile_size;
    const int right = std::min((strip.last_column + 1) * raster::tile_size, tiles.width);
    for (std::size_t i = 0; i < waiting.size(); ++i) {
      const Waiting& w = waiting[i];
      const int x0 = std::max(w.x0, left), x1 = std::min(w.x1, right);
      if (x0 >= x1 || (std::isfinite(w.near) && kernels->hides(tiles, x0, w.y0, x1, w.y1, w.near))) continue;
      const OccluderInstance& occluder = occluders[w.index];
      const auto mesh_view = view.mesh_view(*occluder.mesh, occluder.transform);
      if (!mesh_view) continue;
      drawn[s * waiting.size() + i] = 1;
      kernels->draw(*occluder.mesh, *mesh_view, tiles, strip);
    }
  }

  void draw_all(std::span<const OccluderInstance> occluders) {
    order(occluders);
    cut_strips(occluders, static_cast<std::size_t>(thread_count()));
    drawn.assign(used_strips * waiting.size(), 0);
    const auto draw_strips = [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) draw_strip(occluders, s);
    };
    parallel_blocks(used_strips, 1, std::ref(draw_strips));  // by reference: the std::function allocates nothing
    for (std::size_t s = 0; s < used_strips; ++s) collect(strips[s]);
    for (std::size_t i = 0; i < waiting.size(); ++i) {
      bool any = false;
      for (std::size_t s = 0; s < used_strips; ++s) any = any || drawn[s * waiting.size() + i] != 0;
      if (any) count(*occluders[waiting[i].index].mesh);
    }
  }
};

OcclusionBuffer::OcclusionBuffer(bool scalar) : state_(std::make_unique<State>()) {
  state_->kernels = scalar ? &raster::scalar_kernels() : &raster::simd_kernels();
}
OcclusionBuffer::~OcclusionBuffer() = default;
OcclusionBuffer::OcclusionBuffer(OcclusionBuffer&&) noexcept = default;
OcclusionBuffer& OcclusionBuffer::operator=(OcclusionBuffer&&) noexcept = default;

void OcclusionBuffer::begin(const View& view, int width, int height, Coverage coverage) {
  assert(width >= 1 && height >= 1);
  assert(coverage == Coverage::squares ||
         (width % view.width == 0 && height % view.height == 0 && width / view.width == height / view.height));
  State& s = *state_;
  s.tiles.resize(width, height);
  s.counts = {};
  s.view = ViewTransform(view, width, height, coverage == Coverage::centres ? 0.0 : 0.5);
  s.query = s.view.query();
}

void OcclusionBuffer::add_occluder(const OccluderMesh& mesh, const Affine& transform) {
  State& s = *state_;
  if (mesh.triangle_count == 0) return;
  // A rectangle that is hidden, or outside of the image, ends it here.
  if (!s.seen(State::world_bounds(mesh.bounds, transform), false)) return;
  const auto mesh_view = s.view.mesh_view(mesh, transform);
  if (!mesh_view) return;
  Strip& strip = s.strips[0];
  strip.begin(s.tiles, 0, s.tiles.across - 1);
  s.kernels->draw(mesh, *mesh_view, s.tiles, strip);
  s.count(mesh);
  s.collect(strip);
}

void OcclusionBuffer::add_occluders(std::span<const OccluderInstance> occluders) { state_->draw_all(occluders); }

void OcclusionBuffer::add_occluder(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                                   const Affine& transform) {
  if (triangles.empty()) return;
  Aabb around;  // of what the triangles use: the other vertices may be many, far away or not finite
  for (const glm::uvec3& t : triangles)
    for (int i = 0; i < 3; ++i) around.extend(positions[t[i]]);
  if (!state_->seen(State::world_bounds(around, transform), false)) return;  // spares the matching of edges
  add_occluder(state_->raw.make(positions, triangles), transform);
}

bool OcclusionBuffer::may_be_seen(const Aabb& box) const { return state_->seen(box, true); }

bool OcclusionBuffer::may_be_seen_by_rectangle(const Aabb& box) const { return state_->seen(box, false); }

bool OcclusionBuffer::may_be_seen(const OrientedBox& box) const {
  const State& s = *state_;
  if (box.bounds.empty()) return false;
  std::array<glm::dvec3, 8> corners;
  for (int i = 0; i < 8; ++i)
    corners[static_cast<std::size_t>(i)] =
        glm::dvec3(to_matrix(box.transform) * glm::dvec4(glm::dvec3(box.bounds.corner(i)), 1.0));
  const Rectangles r = s.rectangle(s.view.footprint(corners));
  if (r.verdict[0] != raster::Verdict::ask) return r.verdict[0] == raster::Verdict::seen;
  if (s.hidden_rectangle(r, 0)) return false;
  const auto local = s.view.local_view(box.transform);
  return !local || !s.hidden_outline(r, 0, box.bounds, *local);
}

bool OcclusionBuffer::may_be_seen(const Sphere& sphere) const {
  return sphere.radius >= 0.0f && state_->seen(state_->view.footprint(sphere.centre, sphere.radius));
}

bool OcclusionBuffer::may_be_seen(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) const {
  const std::array<glm::dvec3, 3> corners{glm::dvec3(a), glm::dvec3(b), glm::dvec3(c)};
  return state_->seen(state_->view.footprint(corners));
}

void OcclusionBuffer::test(std::span<const Aabb> boxes, std::span<std::uint8_t> seen, bool outlines) const {
  assert(boxes.size() == seen.size());
  const State& s = *state_;
  const auto test_block = [&](std::size_t begin, std::size_t end) {
    Rectangles r;
    for (std::size_t i = begin; i < end; i += Rectangles::capacity) {
      const std::size_t count = std::min(Rectangles::capacity, end - i);
      s.kernels->project_boxes(s.query, floats(&boxes[i]), count, r);
      for (std::size_t k = 0; k < count; ++k) seen[i + k] = s.seen(r, k, boxes[i + k], outlines) ? 1 : 0;
    }
  };
  parallel_blocks(boxes.size(), 1024, std::ref(test_block));
}

int OcclusionBuffer::width() const { return state_->tiles.width; }
int OcclusionBuffer::height() const { return state_->tiles.height; }

float OcclusionBuffer::hidden_beyond(int x, int y) const {
  const float near = state_->tiles.at(x, y);
  if (near == raster::nothing_near) return std::numeric_limits<float>::infinity();
  return state_->view.perspective ? 1.0f / near : -near;
}

const OcclusionCounts& OcclusionBuffer::counts() const { return state_->counts; }
const char* OcclusionBuffer::target() const { return state_->kernels->target; }

}  // namespace sightline
