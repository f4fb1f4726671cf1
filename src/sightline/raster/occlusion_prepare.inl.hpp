// From a mesh in a view to a list of what to draw: vertices to pixels, components that lie outside of the image, are
// too small to cover a pixel, or are hidden already dropped whole, facing of triangles, contour edges. Included by
// occlusion_kernels.inl.hpp's users, once per SIMD target.

#if defined(SIGHTLINE_RASTER_OCCLUSION_PREPARE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_RASTER_OCCLUSION_PREPARE_INL
#undef SIGHTLINE_RASTER_OCCLUSION_PREPARE_INL
#else
#define SIGHTLINE_RASTER_OCCLUSION_PREPARE_INL
#endif

#include "sightline/geometry/lane_ids.inl.hpp"
#include "sightline/raster/occlusion_kernels.inl.hpp"
#include "sightline/raster/occlusion_query.inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::raster::HWY_NAMESPACE {

using sightline::HWY_NAMESPACE::store_lane_ids;

/// What Scratch::code says of a vertex: it lies beyond a side of the strip or image, before the near plane (a triangle
/// all of whose corners do meets no pixel), or where floats get it wrong.
enum VertexCode : std::int32_t { left_of = 1, right_of = 2, above = 4, below = 8, before_near = 16, wrong = 32 };
inline constexpr std::int32_t outside_codes = left_of | right_of | above | below | before_near;

/// Vertices to pixels, with their codes.
template <bool partial>
HWY_INLINE void project(const OccluderMesh& mesh, const MeshView& view, const Tiles& tiles, Strip& strip) {
  Scratch& out = strip.scratch;
  const Float d;
  const Int di;
  const ScreenTransform& t = view.screen;
  const auto one = hn::Set(d, 1.0f);
  const auto border = [&](int pixel, float centre, float aside)
                          SIGHTLINE_INLINE_LAMBDA { return hn::Set(d, static_cast<float>(pixel) - centre + aside); };
  const auto left = border(strip.first_column * tile_size, t.centre_x, -view.aside);
  const auto right = border((strip.last_column + 1) * tile_size, t.centre_x, view.aside);
  const auto top = border(0, t.centre_y, -view.aside), bottom = border(tiles.height, t.centre_y, view.aside);
  const auto code_if = [&](auto mask, std::int32_t code) SIGHTLINE_INLINE_LAMBDA {
    return hn::IfThenElseZero(hn::RebindMask(di, mask), hn::Set(di, code));
  };
  const auto row = [&](const float* m, auto dx, auto dy, auto dz) SIGHTLINE_INLINE_LAMBDA {
    return hn::Add(hn::Add(hn::Mul(hn::Set(d, m[0]), dx), hn::Mul(hn::Set(d, m[1]), dy)),
                   hn::Mul(hn::Set(d, m[2]), dz));
  };
  const auto size = [&](const float* m, auto dx, auto dy, auto dz) SIGHTLINE_INLINE_LAMBDA {
    return hn::Add(hn::Add(hn::Mul(hn::Set(d, std::abs(m[0])), dx), hn::Mul(hn::Set(d, std::abs(m[1])), dy)),
                   hn::Mul(hn::Set(d, std::abs(m[2])), dz));
  };
  const auto relative = [&](const std::vector<float>& p, std::size_t i, int axis) SIGHTLINE_INLINE_LAMBDA {
    return hn::Sub(hn::Sub(hn::LoadU(d, p.data() + i), hn::Set(d, t.eye_high[axis])), hn::Set(d, t.eye_low[axis]));
  };
  for (std::size_t i = 0; i < mesh.vertex_count; i += float_lanes()) {
    const auto dx = relative(mesh.x, i, 0), dy = relative(mesh.y, i, 1), dz = relative(mesh.z, i, 2);
    auto x = row(t.to_x, dx, dy, dz), y = row(t.to_y, dx, dy, dz);
    const auto w = row(t.to_w, dx, dy, dz);
    const auto h = t.perspective ? w : one;
    auto code =
        hn::Or(hn::Or(code_if(hn::Lt(x, hn::Mul(left, h)), left_of), code_if(hn::Gt(x, hn::Mul(right, h)), right_of)),
               hn::Or(code_if(hn::Lt(y, hn::Mul(top, h)), above), code_if(hn::Gt(y, hn::Mul(bottom, h)), below)));
    auto near = hn::Neg(w);
    auto per_w = one;
    if (t.perspective) {
      near = per_w = hn::Div(one, w);
      x = hn::Mul(x, near);
      y = hn::Mul(y, near);
    }
    if constexpr (partial) {
      // The products' sizes bound the rounding: see OcclusionBuffer's within_guard.
      const auto ax = hn::Abs(dx), ay = hn::Abs(dy), az = hn::Abs(dz);
      const auto size_w = hn::Mul(size(t.to_w, ax, ay, az), per_w);
      const auto size_x = hn::Mul(size(t.to_x, ax, ay, az), per_w), size_y = hn::Mul(size(t.to_y, ax, ay, az), per_w);
      const auto aside = hn::Max(hn::Abs(x), hn::Abs(y));
      auto pixels = hn::Max(size_x, size_y);
      if (t.perspective) pixels = hn::Add(pixels, hn::Mul(aside, size_w));
      auto valid = hn::And(hn::Gt(w, hn::Set(d, view.nearest)), hn::Lt(aside, hn::Set(d, view.guard)));
      valid = hn::And(valid, hn::Lt(hn::Mul(pixels, hn::Set(d, 0x1p-22f)), hn::Set(d, 0x1p-7f)));
      valid = hn::And(valid, hn::Lt(size_w, hn::Set(d, view.error_w)));
      const auto before = hn::Le(w, hn::Set(d, static_cast<float>(view.clip.near)));
      code = hn::Or(code, hn::Or(code_if(before, before_near), code_if(hn::Not(valid), wrong)));
    }
    hn::StoreU(code, di, out.code.data() + i);
    hn::StoreU(hn::Add(x, hn::Set(d, t.centre_x)), d, out.x.data() + i);
    hn::StoreU(hn::Add(y, hn::Set(d, t.centre_y)), d, out.y.data() + i);
    hn::StoreU(near, d, out.near.data() + i);
  }
}

/// Of the projected vertices of a component.
struct ScreenBounds {
  float low_x, high_x, low_y, high_y, nearest;
  bool valid;  // floats get all vertices right; otherwise the rest means nothing
};

HWY_INLINE ScreenBounds bounds_of(const Scratch& s, std::size_t begin, std::size_t end) {
  const Float d;
  const Int di;
  auto codes = hn::Zero(di);
  const auto high = hn::Set(d, std::numeric_limits<float>::infinity()), low = hn::Neg(high);
  auto low_x = high, high_x = low, low_y = high, high_y = low, nearest = low;
  for (std::size_t i = begin; i < end; i += float_lanes()) {
    const auto here = hn::FirstN(d, std::min(float_lanes(), end - i));
    const auto x = hn::LoadU(d, s.x.data() + i), y = hn::LoadU(d, s.y.data() + i),
               near = hn::LoadU(d, s.near.data() + i);
    low_x = hn::Min(low_x, hn::IfThenElse(here, x, high));
    high_x = hn::Max(high_x, hn::IfThenElse(here, x, low));
    low_y = hn::Min(low_y, hn::IfThenElse(here, y, high));
    high_y = hn::Max(high_y, hn::IfThenElse(here, y, low));
    nearest = hn::Max(nearest, hn::IfThenElse(here, near, low));
    codes = hn::Or(codes, hn::IfThenElseZero(hn::RebindMask(di, here), hn::LoadU(di, s.code.data() + i)));
  }
  return {
      hn::GetLane(hn::MinOfLanes(d, low_x)),   hn::GetLane(hn::MaxOfLanes(d, high_x)),
      hn::GetLane(hn::MinOfLanes(d, low_y)),   hn::GetLane(hn::MaxOfLanes(d, high_y)),
      hn::GetLane(hn::MaxOfLanes(d, nearest)), hn::AllFalse(di, hn::TestBit(codes, hn::Set(di, std::int32_t{wrong})))};
}

/// True if what counts of a pixel fits nowhere between low and high, less the margin, within the image.
HWY_INLINE bool holds_no_pixel(float low, float high, const Margins& margins, int pixels) {
  const float inset = margins.pixels + margins.square - 0.5f;
  const float first = std::ceil(std::max(low + inset, 0.0f));
  const float last = std::floor(std::min(high - inset, static_cast<float>(pixels)));
  return !(first + 1.0f <= last);
}

class Preparation {
 public:
  HWY_INLINE Preparation(const OccluderMesh& mesh, const MeshView& view, const Tiles& tiles, Strip& strip)
      : mesh_(mesh), view_(view), tiles_(tiles), strip_(strip), s_(strip.scratch), out_(strip.list) {}

  HWY_INLINE void component(std::size_t c) {
    const ScreenBounds bounds = bounds_of(s_, mesh_.vertex_begin[c], mesh_.vertex_begin[c + 1]);
    nearest_ = std::numeric_limits<float>::infinity();
    rows_ = {0, tiles_.down - 1};
    columns_ = {strip_.first_column, strip_.last_column};
    const float margin = view_.margins.pixels;
    if (bounds.valid) {
      if (holds_no_pixel(bounds.low_x, bounds.high_x, view_.margins, tiles_.width) ||
          holds_no_pixel(bounds.low_y, bounds.high_y, view_.margins, tiles_.height))
        return;
      nearest_ = bounds.nearest + std::abs(bounds.nearest) * 0x1p-12f;  // also of what rounding makes of it
      columns_ = within(tile_range(bounds.low_x - margin, bounds.high_x + margin, tiles_.width), strip_);
      rows_ = tile_range(bounds.low_y - margin, bounds.high_y + margin, tiles_.height);
      if (hides_tiles(tiles_, columns_, rows_, nearest_)) return;
    }
    begin_ = mesh_.triangle_begin[c];
    end_ = mesh_.triangle_begin[c + 1];
    front_ = back_ = 0;
    if (view_.screen.perspective && !mesh_.offset.empty())
      classify_by_planes();
    else if (bounds.valid)
      classify_by_projection();
    else
      classify_exactly();
    s_.facing[mesh_.triangle_count] = 0.0f;
    side(c, 1.0f, s_.front, front_, !bounds.valid);
    if (!mesh_.closed) side(c, -1.0f, s_.back, back_, !bounds.valid);
  }

 private:
  /// Fills `facing` (> 0 front, < 0 back, 0 without area) and the lists of front and back faces by the side of its
  /// plane that the eye is on. Triangles whose plane passes the eye within the rounding of the floats are judged by
  /// their projection.
  HWY_INLINE void classify_by_planes() {
    const Float d;
    const float* eye = view_.screen.eye_high;
    const auto x = hn::Set(d, eye[0]), y = hn::Set(d, eye[1]), z = hn::Set(d, eye[2]);
    // Rounding of the eye, the plane, the products and the sums: each at most 2^-24 of the terms' sizes, nine in all.
    constexpr float rounding = 0x1p-20f;
    const auto eye_error = hn::Set(d, (std::abs(eye[0]) + std::abs(eye[1]) + std::abs(eye[2])) * rounding);
    for (std::size_t i = begin_; i < end_; i += float_lanes()) {
      const auto offset = hn::LoadU(d, mesh_.offset.data() + i);
      const auto in_plane = hn::Add(hn::Add(hn::Mul(x, hn::LoadU(d, mesh_.normal_x.data() + i)),
                                            hn::Mul(y, hn::LoadU(d, mesh_.normal_y.data() + i))),
                                    hn::Mul(z, hn::LoadU(d, mesh_.normal_z.data() + i)));
      auto facing = hn::Add(in_plane, offset);
      const auto error = hn::Add(eye_error, hn::Mul(hn::Abs(offset), hn::Set(d, rounding)));
      // Not (|facing| > error), so that what is no number is unsure.
      const auto sure = hn::Gt(hn::Abs(facing), error);
      hn::StoreU(facing, d, s_.facing.data() + i);
      if (!hn::AllTrue(d, sure)) {
        std::uint32_t bits = bits_of(d, hn::AndNot(sure, here(i)));
        for (std::size_t k = i; bits != 0; ++k, bits >>= 1)
          if ((bits & 1u) != 0) s_.facing[k] = exact_facing(k);
        facing = hn::LoadU(d, s_.facing.data() + i);
      }
      list(i, facing);
    }
  }

  /// The same by the projections' areas.
  HWY_INLINE void classify_by_projection() {
    const Float d;
    const Int di;
    for (std::size_t i = begin_; i < end_; i += float_lanes()) {
      const auto c0 = hn::LoadU(di, mesh_.corner0.data() + i), c1 = hn::LoadU(di, mesh_.corner1.data() + i),
                 c2 = hn::LoadU(di, mesh_.corner2.data() + i);
      const auto x0 = hn::GatherIndex(d, s_.x.data(), c0), x1 = hn::GatherIndex(d, s_.x.data(), c1),
                 x2 = hn::GatherIndex(d, s_.x.data(), c2);
      const auto y0 = hn::GatherIndex(d, s_.y.data(), c0), y1 = hn::GatherIndex(d, s_.y.data(), c1),
                 y2 = hn::GatherIndex(d, s_.y.data(), c2);
      auto facing = hn::Sub(hn::Mul(hn::Sub(x2, x0), hn::Sub(y1, y0)), hn::Mul(hn::Sub(x1, x0), hn::Sub(y2, y0)));
      if (view_.mirrored) facing = hn::Neg(facing);
      hn::StoreU(facing, d, s_.facing.data() + i);
      list(i, facing);
    }
  }

  HWY_INLINE void classify_exactly() {
    for (std::size_t i = begin_; i < end_; ++i) s_.facing[i] = exact_facing(i);
    for (std::size_t i = begin_; i < end_; i += float_lanes()) list(i, hn::LoadU(Float(), s_.facing.data() + i));
  }

  [[nodiscard]] HWY_INLINE hn::Mask<Float> here(std::size_t i) const {
    return hn::FirstN(Float(), std::min(float_lanes(), end_ - i));
  }
  HWY_INLINE void list(std::size_t i, hn::Vec<Float> facing) {
    const Float d;
    const auto zero = hn::Zero(d);
    front_ += store_lane_ids(d, hn::And(here(i), hn::Gt(facing, zero)), i, s_.front.data() + front_);
    if (mesh_.closed) return;
    back_ += store_lane_ids(d, hn::And(here(i), hn::Lt(facing, zero)), i, s_.back.data() + back_);
  }

  /// Of a triangle by its projection; in double precision if floats get a corner wrong.
  [[nodiscard]] float exact_facing(std::size_t i) const {
    const auto a = static_cast<std::size_t>(mesh_.corner0[i]), b = static_cast<std::size_t>(mesh_.corner1[i]),
               c = static_cast<std::size_t>(mesh_.corner2[i]);
    float facing = (s_.x[c] - s_.x[a]) * (s_.y[b] - s_.y[a]) - (s_.x[b] - s_.x[a]) * (s_.y[c] - s_.y[a]);
    if (((s_.code[a] | s_.code[b] | s_.code[c]) & wrong) != 0) {
      const double area =
          clip_facing(view_.clip, position(mesh_.corner0[i]), position(mesh_.corner1[i]), position(mesh_.corner2[i]));
      facing = area > 0.0 ? 1.0f : area < 0.0 ? -1.0f : 0.0f;
    }
    return view_.mirrored ? -facing : facing;
  }

  [[nodiscard]] glm::vec3 position(std::int32_t vertex) const {
    const auto v = static_cast<std::size_t>(vertex);
    return {mesh_.x[v], mesh_.y[v], mesh_.z[v]};
  }

  HWY_INLINE void side(std::size_t c, float sign, const std::vector<std::int32_t>& triangles, std::size_t count,
                       bool with_clipped) {
    s_.facing[mesh_.triangle_count + 1] = sign;
    const auto first_run = static_cast<std::uint32_t>(out_.runs.size());
    Run run{out_.triangles, 0, out_.edges, 0, view_.margins, nearest_, rows_.first, rows_.last, columns_.first,
            columns_.last};
    const std::size_t clipped = take_triangles(triangles, count);
    if (out_.triangles == run.first_triangle && clipped == 0) return;
    const std::size_t contours = find_contours(c, sign);
    out_.reserve(0, contours);
    std::size_t to_clip = 0;
    for (std::size_t k = 0; k < contours; ++k) {
      const auto e = static_cast<std::size_t>(s_.edges[k]);
      const auto from = static_cast<std::size_t>(mesh_.edge_from[e]), to = static_cast<std::size_t>(mesh_.edge_to[e]);
      if (((s_.code[from] | s_.code[to]) & wrong) != 0) {
        s_.edges[to_clip++] = s_.edges[k];
        continue;
      }
      out_.edge_x[0][out_.edges] = s_.x[from];
      out_.edge_y[0][out_.edges] = s_.y[from];
      out_.edge_x[1][out_.edges] = s_.x[to];
      out_.edge_y[1][out_.edges] = s_.y[to];
      out_.edge_near[0][out_.edges] = s_.near[from];
      out_.edge_near[1][out_.edges] = s_.near[to];
      ++out_.edges;
    }
    run.last_triangle = out_.triangles;
    run.last_edge = out_.edges;
    out_.runs.push_back(run);
    out_.surfaces.push_back({nearest_, first_run, first_run + 1});
    if (!with_clipped) return;
    ++out_.surfaces.back().last;
    run.first_triangle = out_.triangles;
    run.first_edge = out_.edges;
    run.margins = view_.clip_margins;
    for (std::size_t k = 0; k < clipped; ++k) {
      const auto i = static_cast<std::size_t>(s_.clipped[k]);
      clip_triangle(view_.clip, position(mesh_.corner0[i]), position(mesh_.corner1[i]), position(mesh_.corner2[i]),
                    out_);
    }
    for (std::size_t k = 0; k < to_clip; ++k) {
      const auto e = static_cast<std::size_t>(s_.edges[k]);
      clip_edge(view_.clip, position(mesh_.edge_from[e]), position(mesh_.edge_to[e]), out_);
    }
    run.last_triangle = out_.triangles;
    run.last_edge = out_.edges;
    out_.runs.push_back(run);
  }

  /// Appends the triangles that can meet the image, but for those that are to be clipped: these go into `clipped`.
  /// Returns their number.
  HWY_INLINE std::size_t take_triangles(const std::vector<std::int32_t>& triangles, std::size_t count) {
    out_.reserve(count, 0);
    std::size_t clipped = 0, at = out_.triangles;
    for (std::size_t k = 0; k < count; ++k) {
      const auto t = static_cast<std::size_t>(triangles[k]);
      const std::size_t corners[3] = {static_cast<std::size_t>(mesh_.corner0[t]),
                                      static_cast<std::size_t>(mesh_.corner1[t]),
                                      static_cast<std::size_t>(mesh_.corner2[t])};
      const std::int32_t codes[3] = {s_.code[corners[0]], s_.code[corners[1]], s_.code[corners[2]]};
      if ((codes[0] & codes[1] & codes[2] & outside_codes) != 0) continue;
      if (((codes[0] | codes[1] | codes[2]) & wrong) != 0) {
        s_.clipped[clipped++] = triangles[k];
        continue;
      }
      for (std::size_t i = 0; i < 3; ++i) {
        out_.x[i][at] = s_.x[corners[i]];
        out_.y[i][at] = s_.y[corners[i]];
        out_.near[i][at] = s_.near[corners[i]];
      }
      ++at;
    }
    out_.triangles = static_cast<std::uint32_t>(at);
    return clipped;
  }

  /// Fills `edges` with the contours of the triangles whose facing has this sign: edges that do not join two of them.
  /// Returns their number.
  HWY_INLINE std::size_t find_contours(std::size_t c, float sign) {
    const Float d;
    const Int di;
    const auto zero = hn::Zero(d), direction = hn::Set(d, sign);
    const std::size_t begin = mesh_.edge_begin[c], end = mesh_.edge_begin[c + 1];
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; i += float_lanes()) {
      const auto drawn = [&](const std::vector<std::int32_t>& triangles) SIGHTLINE_INLINE_LAMBDA {
        const auto facing = hn::GatherIndex(d, s_.facing.data(), hn::LoadU(di, triangles.data() + i));
        return hn::Gt(hn::Mul(facing, direction), zero);
      };
      const auto first = drawn(mesh_.edge_first), second = drawn(mesh_.edge_second);
      const auto inner = hn::And(hn::And(first, second), hn::Gt(hn::LoadU(d, mesh_.edge_winding.data() + i), zero));
      auto contour = hn::AndNot(inner, hn::Or(first, second));
      contour = hn::And(contour, hn::FirstN(d, std::min(float_lanes(), end - i)));
      count += store_lane_ids(d, contour, i, s_.edges.data() + count);
    }
    return count;
  }

  const OccluderMesh& mesh_;
  const MeshView& view_;
  const Tiles& tiles_;
  const Strip& strip_;
  Scratch& s_;
  DrawList& out_;
  std::size_t begin_ = 0, end_ = 0, front_ = 0, back_ = 0;
  float nearest_ = 0;
  TileRange rows_{0, -1}, columns_{0, -1};
};

inline void draw(const OccluderMesh& mesh, const MeshView& view, Tiles& tiles, Strip& strip) {
  constexpr std::size_t padding = 2 * tile_pixels;
  Scratch& s = strip.scratch;
  if (s.x.size() < mesh.vertex_count + padding) {
    for (auto* array : {&s.x, &s.y, &s.near}) array->resize(mesh.vertex_count + padding);
    s.code.resize(mesh.vertex_count + padding);
  }
  if (s.facing.size() < mesh.triangle_count + padding) {
    s.facing.resize(mesh.triangle_count + padding);
    for (auto* array : {&s.front, &s.back, &s.clipped}) array->resize(mesh.triangle_count + padding);
  }
  if (s.edges.size() < mesh.edge_count + padding) s.edges.resize(mesh.edge_count + padding);
  if (view.partial)
    project<true>(mesh, view, tiles, strip);
  else
    project<false>(mesh, view, tiles, strip);
  strip.list.clear();
  Preparation preparation(mesh, view, tiles, strip);
  for (std::size_t c = 0; c + 1 < mesh.triangle_begin.size(); ++c) preparation.component(c);
  strip.triangles_filled += strip.list.triangles;
  draw_list(tiles, strip);
}

}  // namespace sightline::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
