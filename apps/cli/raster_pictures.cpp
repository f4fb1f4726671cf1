#include "raster_pictures.hpp"

#include <algorithm>
#include <cmath>

#include "sightline/raster/abuffer.hpp"
#include "sightline/raster/csg.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/generate/shapes.hpp"
#include "sightline/scene/view.hpp"

namespace sightline::cli {
namespace {

using raster::Target;

constexpr int size = 240;  // pixels across and down a panel
const glm::vec4 red{0.86f, 0.27f, 0.22f, 1}, blue{0.22f, 0.45f, 0.80f, 1}, sand{0.93f, 0.86f, 0.68f, 1},
    paper{0.96f, 0.96f, 0.94f, 1};

Target panel() {
  Target target(size, size);
  target.clear_colour(raster::State(), paper);
  return target;
}

/// Panels side by side, with a gap; `across` in a row.
Picture joined(const std::vector<Target>& panels, int across) {
  constexpr int gap = 6;
  const int count = static_cast<int>(panels.size()), down = (count + across - 1) / across;
  Picture picture{across * (size + gap) - gap, down * (size + gap) - gap, {}};
  picture.rgb.assign(static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height) * 3, 255);
  for (int p = 0; p < count; ++p)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const Target& from = panels[static_cast<std::size_t>(p)];
        const glm::vec4 colour = raster::unpack_colour(from.colour[from.index(x, y)]);
        const int px = p % across * (size + gap) + x, py = p / across * (size + gap) + y;
        for (int k = 0; k < 3; ++k)
          picture.rgb[static_cast<std::size_t>((py * picture.width + px) * 3 + k)] =
              static_cast<std::uint8_t>(std::lround(255.0f * colour[k]));
      }
  return picture;
}

/// A mesh in one colour, lit from above and from the left; back faces as if seen from inside.
struct Lit {
  static constexpr std::size_t varyings = 0;
  static constexpr bool discards = false, writes_depth = false;
  const Mesh& mesh;
  Affine place;
  glm::dmat4 to_clip;
  glm::vec4 colour;

  [[nodiscard]] glm::vec3 corner(std::uint32_t i) const { return transform_point(place, mesh.positions[i]); }
  [[nodiscard]] raster::ClipVertex<0> vertex(std::uint32_t i) const {
    return {glm::vec4(to_clip * glm::dvec4(corner(i), 1.0)), {}};
  }
  bool fragment(const raster::Fragment<0>& in, raster::FragmentResult& out) const {
    const glm::uvec3& t = mesh.triangles[in.triangle];
    const glm::vec3 a = corner(t.x), cross = glm::cross(corner(t.y) - a, corner(t.z) - a);
    const float length = glm::length(cross);
    const glm::vec3 n = length > 0 ? cross / length : glm::vec3(0, 1, 0);
    const float light = 0.55f + 0.45f * glm::dot(in.front ? n : -n, glm::normalize(glm::vec3(-0.5f, 0.8f, 0.35f)));
    out.colour = glm::vec4(light * glm::vec3(colour), colour.a);
    return true;
  }
  [[nodiscard]] std::span<const glm::uvec3> triangles() const { return mesh.triangles; }
};

/// Triangles given in the window, 0 to 1 from the top left, one colour.
struct Flat {
  static constexpr std::size_t varyings = 0;
  static constexpr bool discards = false, writes_depth = false;
  std::vector<glm::vec2> corners;
  glm::vec4 colour;
  float z = 0.5f;

  [[nodiscard]] raster::ClipVertex<0> vertex(std::uint32_t i) const {
    return {{2 * corners[i].x - 1, 1 - 2 * corners[i].y, 2 * z - 1, 1}, {}};
  }
  bool fragment(const raster::Fragment<0>&, raster::FragmentResult& out) const {
    out.colour = colour;
    return true;
  }
  [[nodiscard]] std::vector<glm::uvec3> triangles() const {
    std::vector<glm::uvec3> t;
    for (std::uint32_t i = 0; i + 2 < corners.size(); i += 3) t.emplace_back(i, i + 1, i + 2);
    return t;
  }
};

/// A star (or, with inner = outer, a disc) around a point of the window.
Flat star(const glm::vec2& centre, float outer, float inner, int points, const glm::vec4& colour) {
  Flat flat{{}, colour};
  const auto tip = [&](int i) {
    const float turn = 3.14159265f * static_cast<float>(i) / static_cast<float>(points);
    return centre + (i % 2 == 0 ? outer : inner) * glm::vec2(std::sin(turn), -std::cos(turn));
  };
  for (int i = 0; i < 2 * points; ++i)
    for (const glm::vec2 corner : {centre, tip(i + 1), tip(i)}) flat.corners.push_back(corner);
  return flat;
}

Flat disc(const glm::vec2& centre, float radius, const glm::vec4& colour) {
  return star(centre, radius, radius, 40, colour);
}

template <class Program>
void draw(const raster::State& state, const Program& program, Target& target) {
  raster::DrawCounts counts;
  const auto triangles = program.triangles();
  raster::draw(state, program, std::span<const glm::uvec3>(triangles), target, counts);
}

Affine placed(float scale, const glm::vec3& at) { return {{scale, 0, 0}, {0, scale, 0}, {0, 0, scale}, at}; }

View looking(const glm::dvec3& eye, const glm::dvec3& at, double fov = 0.7) {
  View view = look_along(eye, at - eye);
  view.width = view.height = size;
  view.fov_y = fov;
  view.far = 100;
  return view;
}

/// A plate with windows: closed and not convex.
Mesh lattice() {
  const float lines[] = {-1.3f, -0.9f, -0.25f, 0.25f, 0.9f, 1.3f};
  std::vector<char> filled(25, 1);
  for (const int window : {6, 8, 16, 18}) filled[static_cast<std::size_t>(window)] = 0;
  return make_plate(lines, lines, filled, 1.0f);
}

/// Balls on the ground.
void draw_balls(const raster::State& state, Target& target, const glm::vec4& colour, float shade) {
  const Mesh ball = make_ball(48, 24), ground = make_box({-6, -0.2f, -6}, {6, 0, 6});
  const glm::dmat4 to_clip = view_projection(looking({3, 3.2, 6}, {0, 0.4, 0}));
  const auto dimmed = [&](const glm::vec4& c) { return glm::vec4(shade * glm::vec3(c), 1.0f); };
  draw(state, Lit{ground, identity_affine(), to_clip, dimmed(sand)}, target);
  for (int i = 0; i < 9; ++i)
    draw(state,
         Lit{ball, placed(0.55f, {1.5f * static_cast<float>(i % 3 - 1), 0.55f, 1.5f * static_cast<float>(i / 3 - 1)}),
             to_clip, dimmed(i % 2 == 0 ? colour : paper)},
         target);
}

/// 8.06: a star goes into the stencil only; the scene is bright where it is 1 and dim elsewhere. The panel beside it is
/// the stencil's contents.
Picture stencil_mask() {
  std::vector<Target> panels{panel(), panel()};
  Target& target = panels[0];
  raster::State mask;
  mask.color_mask = {false, false, false, false};
  mask.depth.enabled = false;
  mask.stencil.enabled = true;
  mask.stencil.front.ref = mask.stencil.back.ref = 1;
  mask.stencil.front.zpass = mask.stencil.back.zpass = raster::StencilOp::replace;
  draw(mask, star({0.5f, 0.54f}, 0.46f, 0.24f, 5, paper), target);
  for (const bool inside : {true, false}) {
    raster::State scene;
    scene.stencil.enabled = true;
    scene.stencil.front.ref = scene.stencil.back.ref = 1;
    scene.stencil.front.func = scene.stencil.back.func = inside ? raster::Compare::equal : raster::Compare::notequal;
    draw_balls(scene, target, red, inside ? 1.0f : 0.3f);
  }
  for (std::size_t i = 0; i < target.stencil.size(); ++i)
    panels[1].colour[i] = raster::pack_colour(target.stencil[i] != 0 ? glm::vec4(1.0f) : glm::vec4(0, 0, 0, 1));
  return joined(panels, 2);
}

/// 8.07: both, what is in both, what is in one only; above convex solids, below ones that are not.
Picture csg() {
  const Mesh box = make_box({-0.8f, -0.8f, -0.8f}, {0.8f, 0.8f, 0.8f}), ball = make_ball(64, 32), grid = lattice();
  const glm::dmat4 to_clip = view_projection(looking({3.2, 2.6, 4.2}, {0, 0, 0}, 0.6));
  std::vector<Target> panels;
  const auto combine = [&](raster::Csg operation, const Lit& a, const Lit& b) {
    panels.push_back(panel());
    raster::DrawCounts counts;
    raster::draw_csg(operation, a, a.triangles(), b, b.triangles(), panels.back(), counts);
  };
  for (const auto operation : {raster::Csg::unite, raster::Csg::intersect, raster::Csg::subtract})
    combine(operation, {box, identity_affine(), to_clip, red}, {ball, placed(1.02f, {0, 0, 0}), to_clip, blue});
  for (const auto operation : {raster::Csg::unite, raster::Csg::intersect, raster::Csg::subtract})
    combine(operation, {grid, identity_affine(), to_clip, red},
            {ball, placed(1.1f, {0.1f, 0.1f, 0.3f}), to_clip, blue});
  return joined(panels, 3);
}

/// 8.08: random numbers in the stencil; the second image comes through where the share is greater.
Picture dissolve() {
  std::vector<Target> panels;
  for (const int share : {0, 64, 128, 192, 255}) {
    panels.push_back(panel());
    Target& target = panels.back();
    draw_balls(raster::State(), target, red, 1.0f);
    Random random(8);
    for (std::uint8_t& s : target.stencil) s = static_cast<std::uint8_t>(random.below(255));
    raster::State second;
    second.stencil.enabled = true;
    second.stencil.front.func = second.stencil.back.func = raster::Compare::greater;
    second.stencil.front.ref = second.stencil.back.ref = static_cast<std::uint8_t>(share);
    target.clear_depth(raster::State());
    raster::State background = second;
    background.depth.enabled = false;
    draw(background, Flat{{{0, 0}, {0, 1}, {1, 1}, {0, 0}, {1, 1}, {1, 0}}, glm::vec4(0.1f, 0.12f, 0.2f, 1)}, target);
    const Mesh grid = lattice();
    const glm::dmat4 to_clip = view_projection(looking({3.2, 2.6, 4.2}, {0, 0, 0}, 0.6));
    draw(second, Lit{grid, identity_affine(), to_clip, blue}, target);
  }
  return joined(panels, 5);
}

/// 8.11: where a solid cuts a plane. Fragments of its faces that lie behind the plane count, front faces down and back
/// faces up in one pass; what is not zero is inside. Left the scene, right the section in red.
Picture two_sided() {
  const Mesh plane = make_box({-2.2f, -0.02f, -2.2f}, {2.2f, 0, 2.2f}), grid = lattice(), ball = make_ball(48, 24);
  const glm::dmat4 to_clip = view_projection(looking({3, 4.4, 4.6}, {0, 0, 0}, 0.72));
  const Affine leaning{{0.9f, 0.43f, 0}, {-0.43f, 0.9f, 0}, {0, 0, 1}, {-0.3f, 0, 0}};
  const Lit solids[] = {{grid, leaning, to_clip, blue}, {ball, placed(0.5f, {1.5f, 0.2f, 1.3f}), to_clip, blue}};
  std::vector<Target> panels{panel(), panel()};
  draw(raster::State(), Lit{plane, identity_affine(), to_clip, sand}, panels[0]);
  panels[1] = panels[0];
  for (const Lit& solid : solids) draw(raster::State(), solid, panels[0]);
  raster::State count;
  count.color_mask = {false, false, false, false};
  count.depth.mask = false;
  count.stencil.enabled = true;
  count.stencil.front.zfail = raster::StencilOp::decr_wrap;
  count.stencil.back.zfail = raster::StencilOp::incr_wrap;
  for (const Lit& solid : solids) draw(count, solid, panels[1]);
  raster::State paint;
  paint.depth.enabled = false;
  paint.stencil.enabled = true;
  paint.stencil.front.func = paint.stencil.back.func = raster::Compare::notequal;
  draw(paint, Flat{{{0, 0}, {0, 1}, {1, 1}, {0, 0}, {1, 1}, {1, 0}}, red}, panels[1]);
  return joined(panels, 2);
}

raster::State blending(const raster::Blend& blend) {
  raster::State state;
  state.blend = blend;
  state.depth.enabled = false;
  return state;
}

/// 7.06: A then B, B then A; and added, where the order does not matter.
Picture blending_orders() {
  const auto a = disc({0.38f, 0.45f}, 0.3f, {0.9f, 0.2f, 0.1f, 0.6f}),
             b = disc({0.62f, 0.55f}, 0.3f, {0.1f, 0.3f, 0.9f, 0.6f});
  std::vector<Target> panels{panel(), panel(), panel()};
  draw(blending(raster::blend_over()), a, panels[0]);
  draw(blending(raster::blend_over()), b, panels[0]);
  draw(blending(raster::blend_over()), b, panels[1]);
  draw(blending(raster::blend_over()), a, panels[1]);
  panels[2].clear_colour(raster::State(), {0.05f, 0.05f, 0.05f, 1});
  draw(blending(raster::blend_additive()), a, panels[2]);
  draw(blending(raster::blend_additive()), b, panels[2]);
  return joined(panels, 3);
}

/// 7.01, 7.03: panes that let two of three colours through, in two orders; on white all three leave black.
Picture colour_filters() {
  std::vector<Target> panels{panel(), panel()};
  std::vector<Flat> panes{disc({0.5f, 0.36f}, 0.27f, {0.1f, 1, 1, 1}), disc({0.36f, 0.6f}, 0.27f, {1, 0.1f, 1, 1}),
                          disc({0.64f, 0.6f}, 0.27f, {1, 1, 0.1f, 1})};
  for (Target& target : panels) {
    target.clear_colour(raster::State(), glm::vec4(1.0f));
    for (const Flat& pane : panes) draw(blending(raster::blend_filter()), pane, target);
    std::reverse(panes.begin(), panes.end());
  }
  return joined(panels, 2);
}

/// 7.07, 7.09, 7.10: glass bodies that run through each other: in the order of the list, sorted by their centres, and
/// by the A-buffer, which sorts every pixel.
Picture glass() {
  const Mesh ball = make_ball(48, 24), box = make_box({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}), grid = lattice();
  const View view = looking({3, 2.4, 5}, {0, 0.5, 0}, 0.66);
  const glm::dmat4 to_clip = view_projection(view);
  const Mesh ground = make_box({-3, -0.2f, -3}, {3, 0, 3}), post = make_cylinder(32);
  const auto tinted = [](glm::vec4 colour) { return glm::vec4(glm::vec3(colour), 0.45f); };
  std::vector<Lit> bodies{{ball, placed(0.8f, {0.35f, 0.8f, 0.7f}), to_clip, tinted({0.2f, 0.75f, 0.4f, 1})},
                          {box, placed(1.5f, {-0.5f, 0.76f, 0.2f}), to_clip, tinted(blue)},
                          {grid, placed(0.6f, {0.9f, 0.8f, -0.6f}), to_clip, tinted(red)}};
  Target opaque = panel();
  draw(raster::State(), Lit{ground, identity_affine(), to_clip, sand}, opaque);
  draw(raster::State(), Lit{post, {{0.2f, 0, 0}, {0, 1.7f, 0}, {0, 0, 0.2f}, {0.1f, 0, -0.1f}}, to_clip, paper},
       opaque);
  raster::State see_through;
  see_through.blend = raster::blend_over();
  see_through.depth.mask = false;
  std::vector<Target> panels(3, opaque);
  for (const Lit& body : bodies) draw(see_through, body, panels[0]);
  std::vector<std::size_t> order{0, 1, 2};
  const auto distance = [&](std::size_t i) { return glm::distance(glm::dvec3(bodies[i].place[3]), view.eye); };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return distance(a) > distance(b); });
  for (const std::size_t i : order) draw(see_through, bodies[i], panels[1]);
  raster::ABuffer buffer(size, size);
  raster::State collect;
  collect.color_mask = {false, false, false, false};
  collect.depth.mask = false;
  raster::DrawCounts counts;
  for (const Lit& body : bodies)
    raster::draw(collect, raster::Collected<Lit>{body, buffer}, body.triangles(), panels[2], counts);
  buffer.resolve(see_through.blend, panels[2]);
  return joined(panels, 3);
}

}  // namespace

std::vector<std::pair<const char*, Picture>> raster_pictures() {
  return {{"stencil_mask", stencil_mask()},
          {"csg", csg()},
          {"dissolve", dissolve()},
          {"two_sided", two_sided()},
          {"blending_orders", blending_orders()},
          {"colour_filters", colour_filters()},
          {"glass", glass()}};
}

}  // namespace sightline::cli
