// The pipeline against OpenGL on whatever EGL offers (Mesa llvmpipe on a machine without a card): the same triangles
// under the same state. After every draw call coverage and stencil must be equal, colour within one step of 255 (three
// where it is blended: llvmpipe blends in 8 bits), depth
// within `depth_tolerance`; then the next draw call starts from OpenGL's image on both sides, so that errors do not add
// up. SIGHTLINE_GL_SCENES=10000 (and SIGHTLINE_GL_SEED) widens the random part; the default is a short share.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>

#include "raster_gl/gl_target.hpp"
#include "sightline/raster/pipeline.hpp"
#include "sightline/scene/generate/random.hpp"

namespace sightline::raster {
namespace {

#ifndef SIGHTLINE_HAS_EPOXY
TEST(PipelineGl, Everything) { GTEST_SKIP() << "NOT COMPARED WITH OPENGL: built without libepoxy"; }
#else

constexpr int size = 64;

struct ColourProgram {
  static constexpr std::size_t varyings = 4;
  static constexpr bool discards = false, writes_depth = false;
  std::span<const GlVertex> vertices;
  [[nodiscard]] ClipVertex<4> vertex(std::uint32_t i) const {
    const glm::vec4& c = vertices[i].colour;
    return {vertices[i].position, {c.r, c.g, c.b, c.a}};
  }
  static bool fragment(const Fragment<4>& in, FragmentResult& out) {
    out.colour = {in.varying[0], in.varying[1], in.varying[2], in.varying[3]};
    return true;
  }
};

struct Difference {
  std::size_t pixels = 0, coverage = 0, stencil = 0;
  unsigned colour = 0;  // largest, steps of 255
  double depth = 0;     // largest, window depth
};

/// By how much the window depths of the two may differ: they evaluate a plane over the triangle in different ways
/// (float here and there), which near steep slopes costs more than a unit of the last place.
double depth_tolerance(DepthFormat format) { return format == DepthFormat::unorm16 ? 1.01 / 65535 : 4.01 / 16777216; }

class PipelineGl : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { gl_ = GlContext::make(reason_); }
  static void TearDownTestSuite() { gl_.reset(); }
  void SetUp() override {
    if (!gl_) GTEST_SKIP() << "NOT COMPARED WITH OPENGL: " << reason_;
  }

  /// Draws under `state` on both sides and compares; both then hold OpenGL's image.
  static Difference step(const State& state, const std::vector<GlVertex>& vertices, const GlTarget& theirs,
                         Target& ours) {
    const Target before = ours;
    std::vector<glm::uvec3> triangles;
    for (std::uint32_t i = 0; i + 2 < vertices.size(); i += 3) triangles.emplace_back(i, i + 1, i + 2);
    DrawCounts counts;
    raster::draw(state, ColourProgram{vertices}, triangles, ours, counts);
    theirs.draw(state, vertices);
    return compare(before, theirs, ours);
  }

  static Difference compare(const Target& before, const GlTarget& theirs, Target& ours) {
    Target gl = ours;
    theirs.read(gl);
    Difference d;
    for (std::size_t i = 0; i < ours.colour.size(); ++i) {
      ++d.pixels;
      if (gl.stencil[i] != ours.stencil[i]) ++d.stencil;
      const std::uint32_t a = gl.depth[i], b = ours.depth[i];
      const double apart = std::abs(depth_value(ours.format, a) - depth_value(ours.format, b));
      // A pixel that only one side has written is a difference of coverage.
      if ((a != before.depth[i]) != (b != before.depth[i]) && apart > depth_tolerance(ours.format))
        ++d.coverage;
      else
        d.depth = std::max(d.depth, apart);
      for (int k = 0; k < 4; ++k) {
        const int one = static_cast<int>((gl.colour[i] >> (8 * k)) & 255),
                  two = static_cast<int>((ours.colour[i] >> (8 * k)) & 255);
        d.colour = std::max(d.colour, static_cast<unsigned>(std::abs(one - two)));
      }
    }
    ours.colour = gl.colour;
    ours.depth = gl.depth;
    ours.stencil = gl.stencil;
    return d;
  }

  static void expect_same(const Difference& d, DepthFormat format, const std::string& what, unsigned colour_steps = 1) {
    EXPECT_EQ(d.coverage, 0u) << what;
    EXPECT_EQ(d.stencil, 0u) << what;
    EXPECT_LE(d.colour, colour_steps) << what;
    EXPECT_LE(d.depth, depth_tolerance(format)) << what;
  }

  static inline std::unique_ptr<GlContext> gl_;
  static inline std::string reason_;
};

/// Window x, y in 1/256 pixels to a clip position that both sides map back to exactly that.
glm::vec4 exact_position(Random& random, float z, float w) {
  const auto coordinate = [&] {
    return (static_cast<float>(random.below(size * 256 + 1)) / (size * 128.0f) - 1.0f) * w;
  };
  const float x = coordinate(), y = coordinate();
  return {x, y, z * w, w};
}

float power_of_two_w(Random& random) { return 0.5f * static_cast<float>(1u << random.below(4)); }

glm::vec4 random_colour(Random& random) {
  return {random.range(0, 1), random.range(0, 1), random.range(0, 1),
          (static_cast<float>(random.below(8)) + 0.5f) / 8.0f};
}

/// A triangle in one of 64 slots of depth that do not overlap: in even slots all at one depth (several triangles may
/// be equal there), in odd ones sloped.
std::vector<GlVertex> random_triangle(Random& random, bool sloped) {
  const auto slot = random.below(32);
  std::vector<GlVertex> v;
  const glm::vec4 first = random_colour(random);
  const bool smooth = random.below(2) == 0;
  for (int i = 0; i < 3; ++i) {
    const float base = static_cast<float>(2 * slot + (sloped ? 1 : 0)) / 32.0f - 1.0f;
    const float z = base + (sloped ? static_cast<float>(random.range(0.0, 1.0 / 40)) : 0.0f);
    glm::vec4 c = smooth ? random_colour(random) : first;
    c.a = first.a;
    v.push_back({exact_position(random, z, power_of_two_w(random)), c});
  }
  return v;
}

Compare random_compare(Random& random) { return static_cast<Compare>(random.below(8)); }

StencilFace random_side(Random& random) {
  const auto mask = [&] { return static_cast<std::uint8_t>(random.below(3) == 0 ? random.below(256) : 255); };
  StencilFace s;
  s.func = random.below(3) == 0 ? Compare::always : random_compare(random);
  s.ref = static_cast<std::uint8_t>(random.below(2) == 0 ? random.below(3) : random.below(256));
  s.mask = mask();
  s.write_mask = mask();
  for (StencilOp* op : {&s.sfail, &s.zfail, &s.zpass}) *op = static_cast<StencilOp>(random.below(8));
  return s;
}

State random_state(Random& random) {
  State s;
  s.scissor.enabled = random.below(3) == 0;
  s.scissor.x = static_cast<int>(random.below(size / 2));
  s.scissor.y = static_cast<int>(random.below(size / 2));
  s.scissor.width = static_cast<int>(random.below(size));
  s.scissor.height = static_cast<int>(random.below(size));
  s.alpha_test.enabled = random.below(4) == 0;
  s.alpha_test.func = random_compare(random);
  s.alpha_test.ref = static_cast<float>(random.below(9)) / 8.0f;
  s.stencil.enabled = random.below(3) != 0;
  s.stencil.front = random_side(random);
  s.stencil.back = random.below(2) == 0 ? s.stencil.front : random_side(random);
  s.depth.enabled = random.below(4) != 0;
  s.depth.func = random_compare(random);
  s.depth.mask = random.below(4) != 0;
  s.blend.enabled = random.below(2) == 0;
  for (BlendFactor* f : {&s.blend.src_rgb, &s.blend.dst_rgb, &s.blend.src_alpha, &s.blend.dst_alpha})
    *f = static_cast<BlendFactor>(random.below(15));
  s.blend.rgb = static_cast<BlendEquation>(random.below(5));
  s.blend.alpha = static_cast<BlendEquation>(random.below(5));
  s.blend.constant = random_colour(random);
  for (bool& on : s.color_mask) on = random.below(5) != 0;
  s.cull = static_cast<CullFace>(random.below(8) < 5 ? 0 : random.below(4));
  s.front_is_ccw = random.below(2) == 0;
  return s;
}

int setting(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::atoi(text);
}

void start(Random& random, const GlTarget& theirs, Target& ours) {
  const State plain;
  const glm::vec4 colour = random_colour(random);
  const auto stencil = static_cast<std::uint8_t>(random.below(3));
  const double z = random.below(3) == 0 ? 0.5 : 1.0;
  ours.clear_colour(plain, colour);
  ours.clear_depth(plain, z);
  ours.clear_stencil(plain, stencil);
  theirs.clear_colour(plain, colour);
  theirs.clear_depth(plain, z);
  theirs.clear_stencil(plain, stencil);
}

TEST_F(PipelineGl, RandomStatesAndTriangles) {
  const int scenes = setting("SIGHTLINE_GL_SCENES", 1000);
  Random random(static_cast<std::uint64_t>(setting("SIGHTLINE_GL_SEED", 1)));
  std::size_t draws = 0, colour_off = 0, depth_off = 0;
  double worst_depth[2] = {0, 0};
  // A driver compiles code for each state, so scenes share a pool of them that changes from time to time.
  std::vector<State> pool;
  const DepthFormat formats[] = {DepthFormat::unorm24, DepthFormat::float32};
  for (int f = 0; f < 2; ++f) {
    const GlTarget theirs(*gl_, size, size, formats[f]);
    Target ours(size, size, formats[f]);
    for (int scene = 0; scene < scenes / 2; ++scene) {
      if (scene % 1000 == 0) {
        pool.clear();
        for (int i = 0; i < std::clamp(scenes / 6, 10, 250); ++i) pool.push_back(random_state(random));
      }
      start(random, theirs, ours);
      for (std::uint32_t i = 0, count = 2 + random.below(6); i < count; ++i) {
        const std::uint32_t which = random.below(static_cast<std::uint32_t>(pool.size()));
        std::vector<GlVertex> triangles;
        for (int t = 0; t < 2; ++t)
          for (const GlVertex& v : random_triangle(random, t == 1 && i % 2 == 1)) triangles.push_back(v);
        // Two sloped triangles of one slot may cross: then who wins is a matter of rounding. One slot, one triangle.
        // Blending: one triangle at a time, because what 8 bits lose in a layer the next layer may multiply.
        const bool blends = pool[which].blend.enabled;
        for (std::size_t from = 0; from < triangles.size(); from += blends ? 3 : 6) {
          const std::vector<GlVertex> some(triangles.begin() + static_cast<std::ptrdiff_t>(from),
                                           triangles.begin() + static_cast<std::ptrdiff_t>(from + (blends ? 3 : 6)));
          const Difference d = step(pool[which], some, theirs, ours);
          ++draws;
          colour_off += d.colour > 0 ? 1 : 0;
          depth_off += d.depth > 0 ? 1 : 0;
          worst_depth[f] = std::max(worst_depth[f], d.depth);
          expect_same(
              d, formats[f],
              "scene " + std::to_string(scene) + ", draw " + std::to_string(i) + ", state " + std::to_string(which),
              blends ? 3 : 1);
        }
        if (HasFailure()) return;
      }
    }
  }
  std::printf(
      "%s: %d scenes, %zu draw calls; colour off by a step in %zu, depth in %zu (at most %.2f and %.2f units of 2^-24 "
      "in 24 bits and float)\n",
      GlContext::renderer().c_str(), scenes, draws, colour_off, depth_off, worst_depth[0] * 16777216,
      worst_depth[1] * 16777216);
}

/// Runs one state over a fixed picture with both facings, hidden and visible parts, several stencil values.
void sweep_one(const State& state, const GlTarget& theirs, Target& ours, Difference& total,
               Difference (*step)(const State&, const std::vector<GlVertex>&, const GlTarget&, Target&)) {
  Random random(5);
  start(random, theirs, ours);
  State prepare;
  prepare.stencil.enabled = true;
  prepare.stencil.front.zpass = prepare.stencil.back.zpass = StencilOp::incr;
  prepare.stencil.front.zfail = prepare.stencil.back.zfail = StencilOp::invert;
  for (int i = 0; i < 5; ++i) {
    const Difference d = step(i < 3 ? prepare : state, random_triangle(random, i == 4), theirs, ours);
    total.coverage += d.coverage;
    total.stencil += d.stencil;
    total.colour = std::max(total.colour, d.colour);
    total.depth = std::max(total.depth, d.depth);
  }
}

TEST_F(PipelineGl, EveryDepthFunctionMaskAndFormat) {
  for (const DepthFormat format : {DepthFormat::unorm16, DepthFormat::unorm24, DepthFormat::float32}) {
    const GlTarget theirs(*gl_, size, size, format);
    Target ours(size, size, format);
    for (int func = 0; func < 8; ++func)
      for (int mask = 0; mask < 3; ++mask) {
        State s;
        s.depth = {mask < 2, static_cast<Compare>(func), mask == 0};
        Difference d;
        Random random(7);
        start(random, theirs, ours);
        for (int i = 0; i < 6; ++i) {
          const Difference one = step(i < 3 ? State() : s, random_triangle(random, i % 2 == 1), theirs, ours);
          if (format == DepthFormat::unorm16) ours.stencil.assign(ours.stencil.size(), 0);
          d.coverage += one.coverage;
          d.colour = std::max(d.colour, one.colour);
          d.depth = std::max(d.depth, one.depth);
        }
        expect_same(d, format, "depth function " + std::to_string(func) + ", mask " + std::to_string(mask));
      }
  }
}

TEST_F(PipelineGl, EveryStencilFunctionAndOperationTwoSided) {
  const GlTarget theirs(*gl_, size, size, DepthFormat::unorm24);
  Target ours(size, size, DepthFormat::unorm24);
  for (int func = 0; func < 8; ++func)
    for (int op = 0; op < 8; ++op) {
      State s;
      s.stencil.enabled = true;
      const auto at = [&](int shift) { return static_cast<StencilOp>((op + shift) % 8); };
      s.stencil.front = {static_cast<Compare>(func), 1, 0xFF, at(0), at(3), at(6), 0xFF};
      s.stencil.back = {static_cast<Compare>((func + 5) % 8), 0xFE, 0x3F, at(5), at(2), at(1), 0xF3};
      Difference d;
      sweep_one(s, theirs, ours, d, step);
      expect_same(d, ours.format, "stencil function " + std::to_string(func) + ", operation " + std::to_string(op));
    }
}

TEST_F(PipelineGl, EveryPairOfBlendFactors) {
  const GlTarget theirs(*gl_, size, size, DepthFormat::unorm24);
  Target ours(size, size, DepthFormat::unorm24);
  for (int source = 0; source < 15; ++source)
    for (int destination = 0; destination < 15; ++destination) {
      State s;
      s.blend.enabled = true;
      s.depth.func = Compare::always;
      s.blend.src_rgb = static_cast<BlendFactor>(source);
      s.blend.dst_rgb = static_cast<BlendFactor>(destination);
      s.blend.src_alpha = static_cast<BlendFactor>((source + 4) % 15);
      s.blend.dst_alpha = static_cast<BlendFactor>((destination + 7) % 15);
      s.blend.rgb = static_cast<BlendEquation>((source + destination) % 5);
      s.blend.alpha = static_cast<BlendEquation>(source % 5);
      s.blend.constant = {0.25f, 0.5f, 0.75f, 0.4f};
      Difference d;
      sweep_one(s, theirs, ours, d, step);
      expect_same(d, ours.format, "blend factors " + std::to_string(source) + " and " + std::to_string(destination), 2);
    }
}

TEST_F(PipelineGl, EveryColourMaskAndScissor) {
  const GlTarget theirs(*gl_, size, size, DepthFormat::unorm24);
  Target ours(size, size, DepthFormat::unorm24);
  for (int bits = 0; bits < 16; ++bits) {
    State s;
    for (int i = 0; i < 4; ++i) s.color_mask[static_cast<std::size_t>(i)] = (bits >> i & 1) != 0;
    s.scissor = {bits % 3 != 0, bits, 2 * bits, 40 - bits, 30};
    Difference d;
    sweep_one(s, theirs, ours, d, step);
    // Clears obey scissor and masks, and ignore the stencil test (E15).
    s.stencil.enabled = true;
    s.stencil.front.func = s.stencil.back.func = Compare::never;
    s.stencil.front.write_mask = s.stencil.back.write_mask = static_cast<std::uint8_t>(0x0F + bits);
    const Target before = ours;
    ours.clear_colour(s, {0.2f, 0.4f, 0.6f, 0.8f});
    ours.clear_depth(s, 0.25);
    ours.clear_stencil(s, 0xA5);
    theirs.clear_colour(s, {0.2f, 0.4f, 0.6f, 0.8f});
    theirs.clear_depth(s, 0.25);
    theirs.clear_stencil(s, 0xA5);
    const Difference clears = compare(before, theirs, ours);
    d.stencil += clears.stencil;
    d.coverage += clears.coverage;
    d.colour = std::max(d.colour, clears.colour);
    expect_same(d, ours.format, "colour mask " + std::to_string(bits));
  }
}

// Any w, and triangles that reach out of the view volume: there the two clip and divide with different roundings, so
// a centre that lies within 1/256 pixel of an edge may fall to either side. How many do is printed and bounded.
TEST_F(PipelineGl, PerspectiveAndClippingUpToRoundingOfVertices) {
  const GlTarget theirs(*gl_, size, size, DepthFormat::float32);
  Target ours(size, size);
  Random random(3);
  std::size_t pixels = 0, coverage = 0;
  for (int i = 0; i < 300; ++i) {
    start(random, theirs, ours);
    std::vector<GlVertex> v;
    for (int k = 0; k < 3; ++k) {
      const double w = random.range(-0.5, 3.0);
      v.push_back({glm::vec4(random.range(-2, 2), random.range(-2, 2), random.range(-1.2, 1.2) * std::abs(w), w),
                   random_colour(random)});
    }
    const Difference d = step(State(), v, theirs, ours);
    pixels += d.pixels;
    coverage += d.coverage;
  }
  std::printf("perspective and clipping: %zu of %zu pixels fall to the other side of an edge\n", coverage, pixels);
  EXPECT_LE(coverage * 2000, pixels);
}

#endif

}  // namespace
}  // namespace sightline::raster
