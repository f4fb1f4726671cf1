#include "sightline/raster/occlusion_buffer.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>

#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/occlusion_hull.hpp"
#include "sightline/raster/occlusion_kernels.hpp"
#include "sightline/raster/occlusion_projection.hpp"
#include "sightline/raster/raw_occluder.hpp"

namespace sightline {

using raster::DrawList;
using raster::Kernels;
using raster::MeshView;
using raster::Rectangles;
using raster::ViewTransform;

namespace {

static_assert(sizeof(Aabb) == 6 * sizeof(float), "boxes are read as six floats");

const float* floats(const Aabb* boxes) { return &boxes->lo.x; }

/// An occluder of a round of add_occluders, with room that is kept.
struct Slot {
  DrawList list;
  raster::Scratch scratch;
  const OccluderInstance* occluder = nullptr;
  bool drawn = false;
};

/// An occluder that is not drawn yet: the rectangle around its box and a nearness that it does not exceed, infinite if
/// it may lie before the near plane.
struct Waiting {
  float near;
  std::uint32_t index;
  int x0, y0, x1, y1;
};

/// A surface of a round: runs [first, last) of a slot's list.
struct Surface {
  float nearest;
  std::uint32_t slot, first, last;
};

}  // namespace

struct OcclusionBuffer::State {
  const Kernels* kernels;
  raster::Tiles tiles;
  ViewTransform view;
  raster::QueryView query{};
  OcclusionCounts counts;
  std::vector<Slot> slots{1};
  std::vector<raster::Band> bands{1};
  std::vector<Waiting> waiting;
  std::vector<Surface> surfaces;
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

  void draw(const OccluderMesh& mesh, const MeshView& mesh_view) {
    Slot& slot = slots[0];
    slot.list.clear();
    kernels->prepare(mesh, mesh_view, tiles, slot.scratch, slot.list);
    count(mesh, slot.list);
    bands[0].index = 0;
    bands[0].count = 1;
    kernels->draw(slot.list, 0, slot.list.runs.size(), tiles, bands[0]);
    collect(bands[0]);
  }

  /// Orders the surfaces of the round's occluders, the near ones first: they spare the work for the others.
  void order_surfaces(std::size_t used) {
    surfaces.clear();
    for (std::uint32_t s = 0; s < used; ++s) {
      const auto& runs = slots[s].list.runs;
      std::uint32_t first = 0;
      for (std::uint32_t r = 0; r < runs.size(); ++r) {
        if (!runs[r].last) continue;
        surfaces.push_back({runs[r].nearest, s, first, r + 1});
        first = r + 1;
      }
    }
    std::sort(surfaces.begin(), surfaces.end(), [](const Surface& a, const Surface& b) {
      if (a.nearest != b.nearest) return a.nearest > b.nearest;
      return a.slot != b.slot ? a.slot < b.slot : a.first < b.first;
    });
  }

  void count(const OccluderMesh& mesh, const DrawList& list) {
    ++counts.occluders;
    counts.occluder_triangles += mesh.triangle_count;
    counts.triangles_filled += list.triangles;
    counts.contour_edges += list.edges;
  }
  void collect(raster::Band& band) {
    counts.tiles_filled += band.counts.tiles;
    band.counts = {};
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
        boxes[i] = occluder.mesh->triangle_count > 0 ? world_bounds(*occluder.mesh, occluder.transform) : Aabb();
      }
      kernels->project_boxes(query, floats(boxes.data()), here, r);
      for (std::size_t i = 0; i < here; ++i)
        if (r.verdict[i] != raster::Verdict::hidden)
          waiting.push_back({r.verdict[i] == raster::Verdict::seen ? std::numeric_limits<float>::infinity() : r.near[i],
                             static_cast<std::uint32_t>(first + i), r.x0[i], r.y0[i], r.x1[i], r.y1[i]});
    }
    std::sort(waiting.begin(), waiting.end(), [](const Waiting& a, const Waiting& b) {
      return a.near != b.near ? a.near > b.near : a.index < b.index;
    });
  }

  static Aabb world_bounds(const OccluderMesh& mesh, const Affine& transform) {
    Aabb bounds;
    for (int i = 0; i < 8; ++i) bounds.extend(transform_point(transform, mesh.bounds.corner(i)));
    return bounds;
  }

  /// Draws the waiting ones from `at` on until a round is full: prepared side by side, drawn by bands of rows.
  std::size_t draw_round(std::span<const OccluderInstance> occluders, std::size_t at, std::uint32_t most_triangles) {
    std::uint32_t triangles = 0;
    std::size_t used = 0;
    for (; at < waiting.size() && triangles < most_triangles; ++at) {
      const Waiting& w = waiting[at];
      if (std::isfinite(w.near) && kernels->hides(tiles, w.x0, w.y0, w.x1, w.y1, w.near)) continue;
      if (slots.size() == used) slots.emplace_back();
      slots[used++].occluder = &occluders[w.index];
      triangles += occluders[w.index].mesh->triangle_count;
    }
    // By reference, so that the std::function allocates nothing.
    const auto prepare = [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Slot& slot = slots[i];
        const OccluderMesh& mesh = *slot.occluder->mesh;
        const auto mesh_view = view.mesh_view(mesh, slot.occluder->transform);
        slot.list.clear();
        slot.drawn = mesh_view.has_value();
        if (slot.drawn) kernels->prepare(mesh, *mesh_view, tiles, slot.scratch, slot.list);
      }
    };
    parallel_blocks(used, 1, std::ref(prepare));
    for (std::size_t i = 0; i < used; ++i)
      if (slots[i].drawn) count(*slots[i].occluder->mesh, slots[i].list);
    order_surfaces(used);
    const auto band_count = static_cast<std::size_t>(thread_count());
    if (bands.size() < band_count) bands.resize(band_count);
    const auto draw_band = [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        bands[i].index = static_cast<std::uint32_t>(i);
        bands[i].count = static_cast<std::uint32_t>(band_count);
        for (const Surface& surface : surfaces)
          kernels->draw(slots[surface.slot].list, surface.first, surface.last, tiles, bands[i]);
      }
    };
    parallel_blocks(band_count, 1, std::ref(draw_band));
    for (std::size_t i = 0; i < band_count; ++i) collect(bands[i]);
    return at;
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
  if (!s.seen(State::world_bounds(mesh, transform), false)) return;
  if (const auto mesh_view = s.view.mesh_view(mesh, transform)) s.draw(mesh, *mesh_view);
}

void OcclusionBuffer::add_occluders(std::span<const OccluderInstance> occluders) {
  State& s = *state_;
  s.order(occluders);
  std::uint32_t most_triangles = 4096;  // few at first: they hide the others
  for (std::size_t at = 0; at < s.waiting.size(); most_triangles = std::min(2 * most_triangles, 65536u))
    at = s.draw_round(occluders, at, most_triangles);
}

void OcclusionBuffer::add_occluder(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                                   const Affine& transform) {
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
