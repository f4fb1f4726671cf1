// What the slides use stencil and blending for: masks, CSG, dissolve, transparency and its order (checklist 7, 8).
#include <gtest/gtest.h>

#include <cmath>

#include "raster/pipeline_fixture.hpp"
#include "sightline/raster/abuffer.hpp"
#include "sightline/scene/generate/random.hpp"

namespace sightline::raster {
namespace {

const glm::vec4 red{1, 0, 0, 1}, green{0, 1, 0, 1}, blue{0, 0, 1, 1};

std::uint32_t at(const Target& t, int x, int y) { return t.colour[t.index(x, y)]; }

// 8.01-8.04: wrapping and clamping, all operations.
TEST(Stencil, Operations) {
  EXPECT_EQ(apply(StencilOp::keep, 7, 3), 7);
  EXPECT_EQ(apply(StencilOp::zero, 7, 3), 0);
  EXPECT_EQ(apply(StencilOp::replace, 7, 3), 3);
  EXPECT_EQ(apply(StencilOp::incr, 255, 3), 255);
  EXPECT_EQ(apply(StencilOp::incr_wrap, 255, 3), 0);
  EXPECT_EQ(apply(StencilOp::decr, 0, 3), 0);
  EXPECT_EQ(apply(StencilOp::decr_wrap, 0, 3), 255);
  EXPECT_EQ(apply(StencilOp::invert, 0x0F, 3), 0xF0);
}

// E13: OpenGL compares (ref & mask) func (stored & mask); with the slide's order GEQUAL would mean the opposite.
TEST(Stencil, ReferenceIsTheLeftOperand) {
  for (int stored = 0; stored < 3; ++stored) {
    Target target(2, 2);
    target.clear_stencil(State(), static_cast<std::uint8_t>(stored));
    State s;
    s.stencil.enabled = true;
    s.stencil.front.func = s.stencil.back.func = Compare::gequal;
    s.stencil.front.ref = s.stencil.back.ref = 1;
    draw_window(s, screen(target, 0.5f), red, target);
    EXPECT_EQ(at(target, 0, 0) != 0, stored <= 1) << stored;
  }
}

// 8.06: mask the scene by an object - draw the mask into the stencil only, then the scene where it is 1.
TEST(Stencil, MasksTheScene) {
  Target target(16, 16);
  State mask;
  mask.color_mask = {false, false, false, false};
  mask.depth.enabled = false;
  mask.stencil.enabled = true;
  mask.stencil.front.ref = mask.stencil.back.ref = 1;
  mask.stencil.front.zpass = mask.stencil.back.zpass = StencilOp::replace;
  draw_window(mask, {{2, 2, 0}, {2, 14, 0}, {14, 2, 0}}, red, target);
  State scene;
  scene.stencil.enabled = true;
  scene.stencil.front.ref = scene.stencil.back.ref = 1;
  scene.stencil.front.func = scene.stencil.back.func = Compare::equal;
  draw_window(scene, screen(target, 0.5f), green, target);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x)
      EXPECT_EQ(at(target, x, y), target.stencil[target.index(x, y)] == 1 ? pack_colour(green) : 0u);
  EXPECT_EQ(at(target, 4, 4), pack_colour(green));
  EXPECT_EQ(at(target, 13, 13), 0u);
}

// 8.08: dissolve - a pattern in the stencil lets the second image through at a growing share of the pixels.
TEST(Stencil, DissolvesFromOneImageToTheOther) {
  for (const int share : {0, 64, 128, 200, 255}) {
    Target target(64, 64);
    Random random(9);
    for (std::uint8_t& s : target.stencil) s = static_cast<std::uint8_t>(random.below(255));
    draw_window(State(), screen(target, 0.5f), red, target);
    State second;
    second.depth.func = Compare::always;
    second.stencil.enabled = true;
    second.stencil.front.func = second.stencil.back.func = Compare::greater;  // share > stored
    second.stencil.front.ref = second.stencil.back.ref = static_cast<std::uint8_t>(share);
    draw_window(second, screen(target, 0.5f), blue, target);
    const auto through = std::count(target.colour.begin(), target.colour.end(), pack_colour(blue));
    EXPECT_NEAR(static_cast<double>(through) / 4096, share / 255.0, 0.03);
  }
}

// 8.11: front and back faces in one pass, each with its own operation.
TEST(Stencil, TwoSidedInOnePass) {
  Target target(8, 8);
  State s;
  s.depth.enabled = false;
  s.stencil.enabled = true;
  s.stencil.front.zpass = StencilOp::incr_wrap;
  s.stencil.back.zpass = StencilOp::decr_wrap;
  auto front = rectangle(0, 0, 4, 8, 0.5f), back = rectangle(4, 0, 8, 8, 0.5f);
  for (std::size_t i = 0; i < back.size(); i += 3) std::swap(back[i], back[i + 1]);
  front.insert(front.end(), back.begin(), back.end());
  draw_window(s, front, red, target);
  EXPECT_EQ(target.stencil[target.index(1, 1)], 1);
  EXPECT_EQ(target.stencil[target.index(6, 1)], 255);
}

// 7.02, 7.06: over, additive and filter; A then B is not B then A, except for the commutative two.
TEST(Blending, OrderMatters) {
  const glm::vec4 a{1, 0.2f, 0, 0.5f}, b{0, 0.4f, 1, 0.25f};
  const auto both = [&](const Blend& blend, const glm::vec4& first, const glm::vec4& second) {
    Target target(2, 2);
    target.clear_colour(State(), {0.6f, 0.6f, 0.6f, 1});
    State s;
    s.depth.enabled = false;
    s.blend = blend;
    draw_window(s, screen(target, 0.5f), first, target);
    draw_window(s, screen(target, 0.5f), second, target);
    return unpack_colour(at(target, 0, 0));
  };
  const glm::vec4 ab = both(blend_over(), a, b), ba = both(blend_over(), b, a);
  // C = alpha_B B + (1 - alpha_B)(alpha_A A + (1 - alpha_A) S)
  EXPECT_NEAR(ab.r, 0.75f * (0.5f * 1 + 0.5f * 0.6f), 1.5f / 255);
  EXPECT_NEAR(ba.r, 0.5f * 1 + 0.5f * (0.75f * 0.6f), 1.5f / 255);
  EXPECT_GT(std::abs(ab.r - ba.r), 0.05f);
  EXPECT_EQ(both(blend_additive(), a, b), both(blend_additive(), b, a));
  const glm::vec4 filtered = both(blend_filter(), {0.5f, 1, 1, 1}, {1, 0.25f, 1, 1});  // 7.01, 7.03: two colour filters
  EXPECT_NEAR(filtered.r, 0.3f, 2.0f / 255);
  EXPECT_NEAR(filtered.g, 0.15f, 2.0f / 255);
}

struct LayerProgram {
  static constexpr std::size_t varyings = 0;
  static constexpr bool discards = false, writes_depth = false;
  const WindowProgram& window;
  std::span<const glm::vec4> colours;
  [[nodiscard]] ClipVertex<0> vertex(std::uint32_t i) const { return {window.vertex(i).position, {}}; }
  bool fragment(const Fragment<0>& in, FragmentResult& out) const {
    out.colour = colours[in.triangle];
    return true;
  }
};

// 7.07, 7.09, E11: transparent triangles sorted back to front, depth test on and writes off, against the A-buffer.
TEST(Blending, SortedTransparencyAgainstTheABuffer) {
  Random random(11);
  for (int round = 0; round < 20; ++round) {
    Target target(32, 32);
    draw_window(State(), {{0, 0, 0.5f}, {0, 32, 0.5f}, {20, 32, 0.5f}}, {0.3f, 0.3f, 0.3f, 1}, target);
    WindowProgram window{{}, {}, 32, 32};
    std::vector<glm::vec4> colours;
    for (int i = 0; i < 12; ++i) {
      for (int k = 0; k < 3; ++k)
        window.vertices.push_back({static_cast<float>(random.below(33)), static_cast<float>(random.below(33)),
                                   0.95f - 0.07f * static_cast<float>(i)});
      colours.push_back({random.uniform(), random.uniform(), random.uniform(), random.range(0.2, 0.8)});
    }
    const LayerProgram program{window, colours};
    const auto triangles = window.triangles();
    State state;
    state.blend = blend_over();
    state.depth.mask = false;
    Target sorted = target, reference = target;
    DrawCounts counts;
    draw(state, program, triangles, sorted, counts);  // they are back to front
    ABuffer buffer(32, 32);
    draw(State(), Collected<LayerProgram>{program, buffer}, triangles, reference, counts);
    buffer.resolve(state.blend, reference);
    std::vector<glm::uvec3> reversed(triangles.rbegin(), triangles.rend());
    int worst = 0;
    for (std::size_t i = 0; i < sorted.colour.size(); ++i)
      for (int k = 0; k < 32; k += 8)
        worst = std::max(worst, std::abs(static_cast<int>(sorted.colour[i] >> k & 255) -
                                         static_cast<int>(reference.colour[i] >> k & 255)));
    EXPECT_LE(worst, 4);  // the target rounds to 8 bits after every layer, the A-buffer once
    EXPECT_EQ(sorted.depth, target.depth);
  }
}

// E11: with the depth test off, what lies behind opaque geometry shines through.
TEST(Blending, DepthTestMustStayOn) {
  Target with(4, 4), without = with;
  State glass;
  glass.blend = blend_over();
  glass.depth.mask = false;
  for (Target* t : {&with, &without}) {
    draw_window(State(), screen(*t, 0.3f), green, *t);
    glass.depth.enabled = t == &with;
    draw_window(glass, screen(*t, 0.6f), {1, 0, 0, 0.5f}, *t);
  }
  EXPECT_EQ(at(with, 1, 1), pack_colour(green));
  EXPECT_NE(at(without, 1, 1), pack_colour(green));
}

// 1.20: occlusion alone tells the order of depths, whatever sizes say: of two overlapping discs the one whose outline
// is whole in the image of the ids is the nearer one.
TEST(Fixtures, OcclusionTellsTheOrderOfDepths) {
  Random random(120);
  const auto disc = [&](float x, float y, float radius, float z) {
    std::vector<WindowVertex> v;
    for (int i = 0; i < 24; ++i)
      for (const int k : {-1, i + 1, i}) {
        const double turn = k * 6.283185307179586 / 24;
        v.push_back(k < 0 ? WindowVertex{x, y, z}
                          : WindowVertex{x + radius * static_cast<float>(std::cos(turn)),
                                         y + radius * static_cast<float>(std::sin(turn)), z});
      }
    return v;
  };
  const auto pixels = [](const Target& t, const glm::vec4& colour) {
    return std::count(t.colour.begin(), t.colour.end(), pack_colour(colour));
  };
  int told = 0, larger_is_behind = 0;
  for (int round = 0; round < 300; ++round) {
    const auto place = [&] { return static_cast<float>(random.range(20, 44)); };
    const auto depth = [&] { return static_cast<float>(random.range(0.1, 0.9)); };
    const float z[2] = {depth(), depth()};
    const float radius[2] = {static_cast<float>(random.range(4, 16)), static_cast<float>(random.range(4, 16))};
    const std::vector<WindowVertex> discs[2] = {disc(place(), place(), radius[0], z[0]),
                                                disc(place(), place(), radius[1], z[1])};
    const glm::vec4 colours[2] = {red, blue};
    Target together(64, 64);
    std::ptrdiff_t whole[2];
    for (const int i : {0, 1}) {
      Target alone(64, 64);
      draw_window(State(), discs[i], colours[i], alone);
      draw_window(State(), discs[i], colours[i], together);
      whole[i] = pixels(alone, colours[i]);
    }
    const bool cut[2] = {pixels(together, red) < whole[0], pixels(together, blue) < whole[1]};
    ASSERT_FALSE(cut[0] && cut[1]);
    if (!cut[0] && !cut[1]) continue;  // they do not overlap: occlusion says nothing
    ++told;
    EXPECT_EQ(cut[1], z[0] < z[1]) << round;
    const int behind = cut[0] ? 0 : 1;
    larger_is_behind += radius[behind] > radius[1 - behind] ? 1 : 0;
  }
  EXPECT_GT(told, 150);
  EXPECT_GT(larger_is_behind, 50);
}

// 1.22: Magritte's riders - an image that no order of the depths of whole objects can produce. Each of two flat shapes
// is in front of the other somewhere; the sorter finds no order, the z-buffer needs different depths per pixel.
TEST(Fixtures, ImpossibleOcclusionHasNoDepthOrder) {
  // Seen in front at (x, y): at pixel 0 A hides B, at pixel 1 B hides A; both cover both pixels.
  const bool a_first[2] = {true, false};
  bool some_order = false;
  for (const bool a_nearer : {true, false})
    some_order = some_order || (a_nearer == a_first[0] && a_nearer == a_first[1]);
  EXPECT_FALSE(some_order);
  // By the pipeline: two rectangles at one depth each, in either order of drawing and depth, never give that image.
  for (const float a : {0.2f, 0.4f})
    for (const float b : {0.3f}) {
      Target target(2, 1);
      draw_window(State(), screen(target, a), red, target);
      draw_window(State(), screen(target, b), blue, target);
      EXPECT_FALSE(at(target, 0, 0) == pack_colour(red) && at(target, 1, 0) == pack_colour(blue));
    }
  // Depths that differ from pixel to pixel do.
  Target target(2, 1);
  draw_window(State(), screen(target, 0.3f), blue, target);
  draw_window(State(), {{0, 0, 0.1f}, {0, 1, 0.1f}, {2, 1, 0.5f}, {0, 0, 0.1f}, {2, 1, 0.5f}, {2, 0, 0.5f}}, red,
              target);
  EXPECT_EQ(at(target, 0, 0), pack_colour(red));
  EXPECT_EQ(at(target, 1, 0), pack_colour(blue));
}

}  // namespace
}  // namespace sightline::raster
