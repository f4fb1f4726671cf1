// The pipeline as one template: vertex -> clip -> setup -> coarse -> fine -> tests. A program is any type with
//   static constexpr std::size_t varyings; static constexpr bool discards, writes_depth;
//   ClipVertex<varyings> vertex(std::uint32_t index) const;
//   bool fragment(const Fragment<varyings>& in, FragmentResult& out) const;   // false: discarded
// and is compiled into the fill loop. Exact and readable rather than fast; tile_rasteriser.hpp is the fast one.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sightline/raster/clip.hpp"
#include "sightline/raster/coarse.hpp"
#include "sightline/raster/fragment_tests.hpp"
#include "sightline/raster/setup.hpp"

namespace sightline::raster {

/// What the fragment part of a program sees.
template <std::size_t N>
struct Fragment {
  int x, y;                      // pixel
  float z;                       // window depth
  bool front;                    // which side of the triangle
  std::uint32_t triangle;        // index within the draw call
  std::array<float, N> varying;  // perspective correct
};

struct FragmentResult {
  glm::vec4 colour{0.0f, 0.0f, 0.0f, 1.0f};
  float depth = 0.0f;  // used if the program writes depth; window depth
};

/// Whether the tests may come before the program: never if it discards or writes depth, nor with an alpha test, because
/// then a fragment that never lives would already have written depth or stencil (4.05, E6).
template <class Program>
bool tests_are_early(const State& state) {
  return state.early_tests && !Program::discards && !Program::writes_depth && !state.alpha_test.enabled;
}

namespace pipeline_detail {

template <class Program>
class Drawer {
  static constexpr std::size_t N = Program::varyings;

 public:
  Drawer(const State& state, const Program& program, Target& target, DrawCounts& counts)
      : state_(state), program_(program), target_(target), counts_(counts), early_(tests_are_early<Program>(state)) {
    counts.early_tests = early_;
  }

  void triangle(const glm::uvec3& corners, std::uint32_t number) {
    ++counts_.triangles;
    polygon_.clear();
    for (int i = 0; i < 3; ++i) polygon_.push_back(program_.vertex(corners[i]));
    clip_polygon(polygon_, scratch_, target_.width, target_.height);
    bool filled = false;
    for (std::size_t i = 2; i < polygon_.size(); ++i)
      filled = fill({&polygon_[0], &polygon_[i - 1], &polygon_[i]}, number) || filled;
    if (filled) ++counts_.triangles_filled;
  }

 private:
  bool fill(const std::array<const ClipVertex<N>*, 3>& v, std::uint32_t number) {
    std::array<WindowPoint, 3> w{};
    for (std::size_t i = 0; i < 3; ++i) w[i] = viewport_transform(v[i]->position, target_.width, target_.height);
    TriangleSetup t;
    if (!set_up(w, target_.width, target_.height, state_.front_is_ccw, t)) return false;
    if (state_.cull == CullFace::both || (state_.cull == CullFace::back && !t.front) ||
        (state_.cull == CullFace::front && t.front)) {
      ++counts_.triangles_culled;
      return false;
    }
    const Plane3 z = plane_through(t, w[0].z, w[1].z, w[2].z);
    const Plane3 inverse_w = plane_through(t, w[0].w, w[1].w, w[2].w);
    std::array<Plane3, N> over_w;
    for (std::size_t k = 0; k < N; ++k)
      over_w[k] =
          plane_through(t, static_cast<double>(v[0]->varying[k]) * w[0].w,
                        static_cast<double>(v[1]->varying[k]) * w[1].w, static_cast<double>(v[2]->varying[k]) * w[2].w);
    each_tile(t, [&](int x, int y, int width, int height, TileCover cover) {
      each_pixel(t, x, y, width, height, cover,
                 [&](int px, int py) { fragment(t, z, inverse_w, over_w, px, py, number); });
    });
    return true;
  }

  void fragment(const TriangleSetup& t, const Plane3& z_plane, const Plane3& inverse_w,
                const std::array<Plane3, N>& over_w, int x, int y, std::uint32_t number) {
    const std::size_t at = target_.index(x, y);
    ++counts_.fragments;
    if (!target_.counts.fragments.empty()) ++target_.counts.fragments[at];
    if (!scissor_passes(state_.scissor, x, y)) {
      ++counts_.scissor_failed;
      return;
    }
    double z = z_plane.at(x, y);
    if (early_ && !stencil_and_depth(state_, t.front, depth_code(target_.format, z), at, target_, counts_)) return;
    Fragment<N> in{x, y, static_cast<float>(z), t.front, number, {}};
    const double w = N > 0 ? 1.0 / inverse_w.at(x, y) : 1.0;
    for (std::size_t k = 0; k < N; ++k) in.varying[k] = static_cast<float>(over_w[k].at(x, y) * w);
    FragmentResult out;
    out.depth = in.z;
    ++counts_.program_runs;
    if (!program_.fragment(in, out)) {
      ++counts_.discarded;
      return;
    }
    if (!alpha_passes(state_.alpha_test, out.colour.a)) {
      ++counts_.alpha_failed;
      return;
    }
    if (Program::writes_depth) z = static_cast<double>(out.depth);
    if (!early_ && !stencil_and_depth(state_, t.front, depth_code(target_.format, z), at, target_, counts_)) return;
    write_colour(state_, out.colour, at, target_, counts_);
  }

  const State& state_;
  const Program& program_;
  Target& target_;
  DrawCounts& counts_;
  bool early_;
  std::vector<ClipVertex<N>> polygon_, scratch_;
};

}  // namespace pipeline_detail

/// Draws triangles in their order; adds to `counts`.
template <class Program>
void draw(const State& state, const Program& program, std::span<const glm::uvec3> triangles, Target& target,
          DrawCounts& counts) {
  pipeline_detail::Drawer<Program> drawer(state, program, target, counts);
  for (std::size_t i = 0; i < triangles.size(); ++i) drawer.triangle(triangles[i], static_cast<std::uint32_t>(i));
}

}  // namespace sightline::raster
