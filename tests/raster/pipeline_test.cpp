// The stages of the pipeline: fill rule, depth formats, interpolation, order of tests, early tests (checklist 3, 4).
#include "sightline/raster/pipeline.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "raster/pipeline_fixture.hpp"
#include "sightline/raster/scene_draw.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/generate/random.hpp"

namespace sightline::raster {
namespace {

const glm::vec4 red{1, 0, 0, 1}, green{0, 1, 0, 1}, blue{0, 0, 1, 1};

std::uint32_t at(const Target& t, int x, int y) { return t.colour[t.index(x, y)]; }

// 3.04, 3.05, E4: a fan around an inner point covers every pixel exactly once, wherever the point lies.
TEST(Fill, TrianglesThatShareEdgesShareNoPixelAndLoseNone) {
  Random random(1);
  for (int round = 0; round < 300; ++round) {
    Target target(32, 32);
    target.count_pixels();
    const auto grid = [&] { return static_cast<float>(random.below(32 * 256 + 1)) / 256.0f; };
    WindowVertex centre{grid(), grid(), 0.5f};
    if (round % 3 == 0) centre = {std::floor(centre.x) + 0.5f, std::floor(centre.y) + 0.5f, 0.5f};  // on a pixel centre
    std::vector<WindowVertex> rim{{0, 0, 0.5f},       {grid(), 0, 0.5f}, {32, 0, 0.5f},
                                  {32, grid(), 0.5f}, {32, 32, 0.5f},    {0, 32, 0.5f}};
    std::vector<WindowVertex> fan;
    for (std::size_t i = 0; i < rim.size(); ++i) {
      fan.push_back(centre);
      fan.push_back(rim[i]);
      fan.push_back(rim[(i + 1) % rim.size()]);
    }
    State s;
    s.depth.enabled = false;
    draw_window(s, fan, red, target);
    for (const std::uint32_t n : target.counts.fragments) ASSERT_EQ(n, 1u) << "round " << round;
  }
}

// The test of the test: without the top-left rule the count would not be one.
TEST(Fill, PixelCentresOnAnEdgeBelongToTheTopLeftTriangle) {
  Target target(8, 8);
  State s;
  draw_window(s, {{0.5f, 0.5f, 0}, {0.5f, 4.5f, 0}, {4.5f, 0.5f, 0}}, red, target);
  EXPECT_EQ(at(target, 0, 0), pack_colour(red));  // on the top and the left edge
  EXPECT_EQ(at(target, 0, 4), 0u);                // end of the right edge
  EXPECT_EQ(at(target, 2, 2), 0u);                // on the right edge
  EXPECT_EQ(at(target, 1, 2), pack_colour(red));
}

// Coarse and fine pass against the plain loop over the bounding box (3.04).
TEST(Fill, TilesCoverWhatThePlainLoopCovers) {
  Random random(2);
  for (int round = 0; round < 500; ++round) {
    std::array<WindowPoint, 3> w{};
    for (WindowPoint& p : w)
      p = {static_cast<float>(random.range(-40, 100)), static_cast<float>(random.range(-40, 100)), 0.5f, 1};
    TriangleSetup t;
    if (!set_up(w, 61, 47, true, t)) continue;
    std::vector<int> tiled(61 * 47), plain(61 * 47);
    each_tile(t, [&](int x, int y, int width, int height, TileCover cover) {
      each_pixel(t, x, y, width, height, cover,
                 [&](int px, int py) { ++tiled[static_cast<std::size_t>(py * 61 + px)]; });
    });
    for (int y = 0; y < 47; ++y)
      for (int x = 0; x < 61; ++x)
        plain[static_cast<std::size_t>(y * 61 + x)] =
            t.edges[0].at(x, y) >= 0 && t.edges[1].at(x, y) >= 0 && t.edges[2].at(x, y) >= 0;
    ASSERT_EQ(tiled, plain) << round;
  }
}

// 3.01-3.03, 3.09: the number example - a polygon of constant depth 5, then one that crosses it.
TEST(ZBuffer, NumberExampleOfTheSlide) {
  Target target(8, 8);
  draw_window(State(), rectangle(0, 0, 5, 8, 0.5f), red, target);
  // From 0.2 at the left to 1 at the right.
  draw_window(State(), {{0, 0, 0.2f}, {0, 8, 0.2f}, {8, 8, 1}, {0, 0, 0.2f}, {8, 8, 1}, {8, 0, 1}}, blue, target);
  for (int x = 0; x < 8; ++x) {
    const double sloped = 0.2 + 0.1 * (x + 0.5);
    const bool first_wins = x < 5 && 0.5 < sloped;
    EXPECT_EQ(at(target, x, 3), pack_colour(first_wins ? red : blue)) << x;
    EXPECT_NEAR(target.depth_at(x, 3), first_wins ? 0.5 : sloped, 1e-6) << x;
  }
}

// 3.02, 3.19: before anything is drawn the buffers hold background and the largest depth.
TEST(ZBuffer, StartsWithBackgroundAndFarthest) {
  for (const DepthFormat f : {DepthFormat::float32, DepthFormat::unorm24, DepthFormat::unorm20, DepthFormat::unorm16}) {
    const Target target(3, 3, f);
    EXPECT_EQ(target.depth_at(1, 1), 1.0);
    EXPECT_EQ(at(target, 1, 1), 0u);
  }
}

// 3.10, E14: at equal depth LESS keeps the first, LEQUAL takes the last: not the same.
TEST(ZBuffer, EqualDepthDependsOnTheFunction) {
  for (const auto& [func, winner] : {std::pair{Compare::less, red}, std::pair{Compare::lequal, blue}}) {
    Target target(4, 4);
    State s;
    s.depth.func = func;
    draw_window(s, screen(target, 0.5f), red, target);
    draw_window(s, screen(target, 0.5f), blue, target);
    EXPECT_EQ(at(target, 2, 2), pack_colour(winner));
  }
}

// 2.04, 3.11: three triangles that overlap in a circle, in every order of drawing: the same image.
TEST(ZBuffer, CyclicOverlapIsTheSameInAnyOrder) {
  const auto blade = [](int k) {
    std::vector<WindowVertex> v;
    const double a = 2.0 * k * 3.14159265358979 / 3;
    for (const auto& [along, across, z] : {std::tuple{-14.0, -3.0, 0.2f}, {-14.0, 3.0, 0.2f}, {14.0, 0.0, 0.8f}})
      v.push_back({std::round(256 * static_cast<float>(16 + along * std::cos(a) - (across - 5) * std::sin(a))) / 256,
                   std::round(256 * static_cast<float>(16 + along * std::sin(a) + (across - 5) * std::cos(a))) / 256,
                   z});
    return v;
  };
  const glm::vec4 colours[] = {red, green, blue};
  std::vector<std::uint32_t> first;
  for (const auto& order : {std::array{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}) {
    Target target(32, 32);
    for (const int k : order) draw_window(State(), blade(k), colours[k], target);
    if (first.empty()) first = target.colour;
    EXPECT_EQ(target.colour, first);
  }
  for (const glm::vec4& c : colours) EXPECT_GT(std::count(first.begin(), first.end(), pack_colour(c)), 20);
}

// 3.12: the work is n triangles plus p fragments: more triangles over the same area leave p as it is, twice the size of
// the image leaves n and makes p four times as many.
TEST(ZBuffer, WorkIsTrianglesPlusFragments) {
  const auto work = [](int cells, int size) {
    Target target(size, size);
    std::vector<WindowVertex> v;
    const float step = static_cast<float>(size / cells);
    for (int i = 0; i < cells * cells; ++i) {
      const float x = step * static_cast<float>(i % cells), y = step * static_cast<float>(i / cells);
      const auto cell = rectangle(x, y, x + step, y + step, 0.5f);
      v.insert(v.end(), cell.begin(), cell.end());
    }
    return draw_window(State(), v, red, target);
  };
  const DrawCounts coarse = work(4, 64), fine = work(16, 64), large = work(4, 128);
  EXPECT_EQ(fine.triangles, 16 * coarse.triangles);
  EXPECT_EQ(fine.fragments, coarse.fragments);
  EXPECT_EQ(large.triangles, coarse.triangles);
  EXPECT_EQ(large.fragments, 4 * coarse.fragments);
}

// 3.02, 3.21: what a z-buffer costs is memory: 1280 x 1024 pixels with 32 bits of depth take eight times the 640 kB
// that once ought to have been enough.
TEST(ZBuffer, MemoryIsTheObjectionOfOldTimes) {
  const Target target(1280, 1024);
  const std::size_t depth_bytes = target.depth.size() * sizeof target.depth[0];
  EXPECT_EQ(depth_bytes, 1280u * 1024u * 4u);
  EXPECT_EQ(depth_bytes / (640 * 1024), 8u);
}

// 3.15: n bits distinguish 2^n depths.
TEST(DepthFormats, CodesAreOrderedAndRoundTrip) {
  for (const DepthFormat f : {DepthFormat::unorm24, DepthFormat::unorm20, DepthFormat::unorm16}) {
    const auto most = (1u << depth_bits(f)) - 1;
    for (const std::uint32_t code : {0u, 1u, 2u, most / 2, most - 1, most})
      EXPECT_EQ(depth_code(f, depth_value(f, code)), code);
    EXPECT_EQ(depth_code(f, 2.0), most);
    EXPECT_EQ(depth_code(f, -1.0), 0u);
  }
  EXPECT_EQ(1u << depth_bits(DepthFormat::unorm20), 1048576u);
  EXPECT_LT(depth_code(DepthFormat::float32, 0.25), depth_code(DepthFormat::float32, 0.2500001));
}

// 3.06-3.08, E5: edges then spans, barycentric weights, plane and plane in steps give the same depth.
TEST(Interpolation, AllFormsOfTheSlidesAgree) {
  Random random(3);
  for (int round = 0; round < 200; ++round) {
    std::array<WindowPoint, 3> w{};
    for (WindowPoint& p : w)
      p = {static_cast<float>(random.below(64 * 256)) / 256, static_cast<float>(random.below(64 * 256)) / 256,
           static_cast<float>(random.uniform()), 1};
    TriangleSetup t;
    if (!set_up(w, 64, 64, true, t) || t.area < 1 << 20) continue;
    const Plane3 plane = plane_through(t, w[0].z, w[1].z, w[2].z);
    // A x + B y + C z + D = 0 by the cross product.
    const glm::dvec3 p0(w[0].x, w[0].y, w[0].z), p1(w[1].x, w[1].y, w[1].z), p2(w[2].x, w[2].y, w[2].z);
    const glm::dvec3 n = glm::cross(p1 - p0, p2 - p0);
    const double d = -glm::dot(n, p0);
    for (int y = t.y0; y < t.y1; ++y) {
      double step = 0;
      bool started = false;
      for (int x = t.x0; x < t.x1; ++x) {
        const double a = static_cast<double>(t.edges[0].at(x, y)), b = static_cast<double>(t.edges[1].at(x, y)),
                     c = static_cast<double>(t.edges[2].at(x, y));
        if (a < 0 || b < 0 || c < 0) continue;
        const double px = x + 0.5, py = y + 0.5;
        const double barycentric = (a * w[0].z + b * w[1].z + c * w[2].z) / (a + b + c);
        const double by_plane = -(d + n.x * px + n.y * py) / n.z;
        // Along the two edges that the row crosses, then along the row.
        double left_x = 1e9, left_z = 0, right_x = -1e9, right_z = 0;
        for (int e = 0; e < 3; ++e) {
          const glm::dvec3 from = e == 0 ? p0 : e == 1 ? p1 : p2, to = e == 0 ? p1 : e == 1 ? p2 : p0;
          if ((from.y <= py) == (to.y <= py)) continue;
          const double s = (py - from.y) / (to.y - from.y), ex = from.x + s * (to.x - from.x),
                       ez = from.z + s * (to.z - from.z);
          if (ex < left_x) left_x = ex, left_z = ez;
          if (ex > right_x) right_x = ex, right_z = ez;
        }
        const double repeated =
            right_x > left_x ? left_z + (px - left_x) / (right_x - left_x) * (right_z - left_z) : left_z;
        step = started ? step - n.x / n.z : by_plane;  // one subtraction per pixel
        started = true;
        EXPECT_NEAR(plane.at(x, y), by_plane, 1e-6);
        EXPECT_NEAR(barycentric, by_plane, 2e-4);  // its weights carry the fill rule's unit
        EXPECT_NEAR(repeated, by_plane, 1e-6);
        EXPECT_NEAR(step, by_plane, 1e-6);
      }
    }
  }
}

struct PerspectiveProgram {
  static constexpr std::size_t varyings = 2;
  static constexpr bool discards = false, writes_depth = false;
  std::array<ClipVertex<2>, 3> vertices;
  mutable double worst = 0;
  [[nodiscard]] ClipVertex<2> vertex(std::uint32_t i) const { return vertices[i]; }
  bool fragment(const Fragment<2>& in, FragmentResult&) const {
    // The varyings are the view position: it must project to where the fragment is.
    const double z = static_cast<double>(in.varying[1]), x = static_cast<double>(in.varying[0]);
    worst = std::max(worst, std::abs((x / z * 0.5 + 0.5) * 256 - (in.x + 0.5)));
    return true;
  }
};

// E5: attributes are affine in the image only over w.
TEST(Interpolation, AttributesArePerspectiveCorrect) {
  PerspectiveProgram program{
      {{{{-0.9f, -0.9f, 0, 1}, {-0.9f, 1}}, {{18, -3, 0, 20}, {18, 20}}, {{0, 4, 0, 5}, {0, 5}}}}};
  Target target(256, 256);
  const std::vector<glm::uvec3> triangles{{0, 1, 2}};
  DrawCounts counts;
  draw(State(), program, triangles, target, counts);
  EXPECT_GT(counts.fragments, 5000u);
  EXPECT_LT(program.worst, 0.02);  // vertices are snapped to 1/256 pixel
}

// 4.08: scissor, alpha, stencil, depth - a fragment that fails one does not reach the next.
TEST(Tests, OrderIsScissorAlphaStencilDepth) {
  Target target(8, 8);
  State s;
  s.scissor = {true, 0, 0, 4, 8};
  s.alpha_test = {true, Compare::greater, 0.5f};
  s.stencil.enabled = true;
  s.stencil.front.sfail = s.stencil.back.sfail = StencilOp::incr;
  s.stencil.front.zfail = s.stencil.back.zfail = StencilOp::decr;
  s.stencil.front.func = s.stencil.back.func = Compare::never;
  s.depth.func = Compare::never;
  const DrawCounts low = draw_window(s, screen(target, 0.5f), {1, 1, 1, 0.2f}, target);
  EXPECT_EQ(low.fragments, 64u);
  EXPECT_EQ(low.scissor_failed, 32u);
  EXPECT_EQ(low.program_runs, 32u);
  EXPECT_EQ(low.alpha_failed, 32u);
  EXPECT_EQ(low.stencil_failed + low.stencil_writes, 0u);
  const DrawCounts high = draw_window(s, screen(target, 0.5f), {1, 1, 1, 0.8f}, target);
  EXPECT_EQ(high.stencil_failed, 32u);
  EXPECT_EQ(high.depth_tests, 0u);
  EXPECT_EQ(target.stencil[target.index(1, 1)], 1);
  EXPECT_EQ(target.stencil[target.index(5, 1)], 0);
  s.stencil.front.func = s.stencil.back.func = Compare::always;
  const DrawCounts depth = draw_window(s, screen(target, 0.5f), {1, 1, 1, 0.8f}, target);
  EXPECT_EQ(depth.depth_failed, 32u);
  EXPECT_EQ(target.stencil[target.index(1, 1)], 0);
  EXPECT_EQ(depth.colour_writes + depth.depth_writes, 0u);
}

// 4.03-4.05, E6: early tests save program runs; they are off when the program discards or writes depth, or with an
// alpha test; the image is the same.
TEST(EarlyZ, SavesProgramRunsAndIsDisabledByItself) {
  const Scene scene = generate_scene("soup", {.objects = 60, .triangles = 0, .seed = 4});
  View view = look_along(glm::dvec3(scene.bounds().centre()) +
                             glm::dvec3(0, 0, 2.0 * static_cast<double>(glm::length(scene.bounds().extent()))),
                         {0, 0, -1});
  view.width = 200;
  view.height = 120;
  view.far = 1e4;
  const std::vector<ObjectId> order = front_to_back(scene, view);
  const auto run = [&](ProgramKind kind, bool early, bool alpha, Target& target) {
    SceneDraw what;
    what.kind = kind;
    what.state.early_tests = early;
    what.state.alpha_test.enabled = alpha;
    DrawCounts counts;
    draw_scene(scene, view, order, what, target, counts);
    return counts;
  };
  Target late_image(view.width, view.height), early_image = late_image, other = late_image;
  const DrawCounts late = run(ProgramKind::plain, false, false, late_image);
  const DrawCounts early = run(ProgramKind::plain, true, false, early_image);
  EXPECT_FALSE(late.early_tests);
  EXPECT_TRUE(early.early_tests);
  EXPECT_EQ(late.program_runs, late.fragments);
  EXPECT_LT(early.program_runs, late.program_runs);
  EXPECT_EQ(early_image.colour, late_image.colour);
  EXPECT_EQ(early_image.depth, late_image.depth);
  EXPECT_FALSE(run(ProgramKind::discards, true, false, other).early_tests);
  EXPECT_FALSE(run(ProgramKind::writes_depth, true, false, other).early_tests);
  EXPECT_FALSE(run(ProgramKind::plain, true, true, other).early_tests);
}

// 4.06, E6: after a depth pre-pass the second pass with EQUAL and no depth writes runs the program once per pixel.
TEST(EarlyZ, DepthPrePassLeavesNoOverdraw) {
  const Scene scene = generate_scene("soup", {.objects = 60, .triangles = 0, .seed = 5});
  View view = look_along(glm::dvec3(scene.bounds().centre()) +
                             glm::dvec3(0, 0, 2.0 * static_cast<double>(glm::length(scene.bounds().extent()))),
                         {0, 0, -1});
  view.width = 200;
  view.height = 120;
  view.far = 1e4;
  std::vector<ObjectId> order = front_to_back(scene, view);
  std::reverse(order.begin(), order.end());  // the worst order
  Target one_pass(view.width, view.height), two_passes = one_pass;
  DrawCounts single, first, second;
  draw_scene(scene, view, order, {}, one_pass, single);
  SceneDraw depth_only;
  depth_only.state.color_mask = {false, false, false, false};
  draw_scene(scene, view, order, depth_only, two_passes, first);
  EXPECT_EQ(first.colour_writes, 0u);
  SceneDraw shading;
  shading.state.depth.func = Compare::equal;
  shading.state.depth.mask = false;
  draw_scene(scene, view, order, shading, two_passes, second);
  const auto covered =
      static_cast<std::uint64_t>(std::count_if(one_pass.depth.begin(), one_pass.depth.end(), [](std::uint32_t d) {
        return d != depth_code(DepthFormat::float32, 1.0);
      }));
  EXPECT_GE(second.program_runs, covered);
  EXPECT_LE(second.program_runs, covered + covered / 200);  // exactly coincident faces pass twice
  EXPECT_LT(second.program_runs, single.program_runs);
  std::size_t different = 0;
  for (std::size_t i = 0; i < one_pass.colour.size(); ++i)
    different += one_pass.colour[i] != two_passes.colour[i] ? 1 : 0;
  EXPECT_LE(different, covered / 200);
}

// 4.07: 200 layers that all pass. Without colour the same depth, the same tests, and half of the words written.
TEST(DepthOnly, WritesHalfOfTheWords) {
  constexpr int layers = 200;
  Target both(32, 16), depth_only = both;
  State no_colour;
  no_colour.color_mask = {false, false, false, false};
  std::uint64_t words_both = 0, words_depth = 0;
  for (int i = 0; i < layers; ++i) {
    const float z = 0.9f - 0.004f * static_cast<float>(i);
    const DrawCounts a = draw_window(State(), screen(both, z), red, both);
    const DrawCounts b = draw_window(no_colour, screen(depth_only, z), red, depth_only);
    EXPECT_EQ(a.depth_tests, b.depth_tests);
    words_both += a.depth_writes + a.colour_writes;
    words_depth += b.depth_writes + b.colour_writes;
  }
  EXPECT_EQ(both.depth, depth_only.depth);
  EXPECT_EQ(words_depth, layers * 32u * 16u);
  EXPECT_EQ(words_both, 2 * words_depth);
  EXPECT_EQ(std::count(depth_only.colour.begin(), depth_only.colour.end(), 0u), 32 * 16);
}

}  // namespace
}  // namespace sightline::raster
