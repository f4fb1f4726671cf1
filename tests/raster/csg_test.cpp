// Solids combined by the stencil buffer against intervals along rays (checklist 8.07).
#include "sightline/raster/csg.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "sightline/scene/generate/shapes.hpp"
#include "sightline/scene/view.hpp"

namespace sightline::raster {
namespace {

const glm::vec4 red{1, 0, 0, 1}, green{0, 1, 0, 1};

std::uint32_t at(const Target& t, int x, int y) { return t.colour[t.index(x, y)]; }

/// A closed mesh seen from a view, one colour.
struct SolidProgram {
  static constexpr std::size_t varyings = 0;
  static constexpr bool discards = false, writes_depth = false;
  const Mesh& mesh;
  glm::dmat4 to_clip;
  glm::vec4 colour;
  [[nodiscard]] ClipVertex<0> vertex(std::uint32_t i) const {
    return {glm::vec4(to_clip * glm::dvec4(glm::dvec3(mesh.positions[i]), 1.0)), {}};
  }
  bool fragment(const Fragment<0>&, FragmentResult& out) const {
    out.colour = colour;
    return true;
  }
};

struct Interval {
  double in, out;  // empty if in >= out
};

Interval slab(const PixelRay& ray, const glm::dvec3& low, const glm::dvec3& high) {
  Interval i{0, 1e9};
  for (int k = 0; k < 3; ++k) {
    const double a = (low[k] - ray.origin[k]) / ray.direction[k], b = (high[k] - ray.origin[k]) / ray.direction[k];
    i.in = std::max(i.in, std::min(a, b));
    i.out = std::min(i.out, std::max(a, b));
  }
  return i;
}

/// First surface of the combination along a ray: 0 nothing, 1 A, 2 B.
int truth(Csg op, const Interval& a, const Interval& b, double& depth) {
  const bool has_a = a.in < a.out, has_b = b.in < b.out;
  if (op == Csg::unite) {
    if (!has_a && !has_b) return 0;
    const bool first = has_a && (!has_b || a.in < b.in);
    depth = first ? a.in : b.in;
    return first ? 1 : 2;
  }
  if (op == Csg::intersect) {
    if (!has_a || !has_b || std::max(a.in, b.in) >= std::min(a.out, b.out)) return 0;
    depth = std::max(a.in, b.in);
    return a.in > b.in ? 1 : 2;
  }
  if (!has_a) return 0;
  if (!has_b || b.in > a.in || b.out < a.in) {
    depth = a.in;
    return 1;
  }
  if (b.out >= a.out) return 0;
  depth = b.out;
  return 2;
}

// 8.07: intersection, union, difference of boxes against intervals along the rays.
TEST(Stencil, ConstructiveSolidGeometry) {
  const glm::vec3 a_low(-1, -1, -1), a_high(1, 1, 1), b_low(-0.3f, -0.4f, 0.2f), b_high(1.7f, 0.6f, 1.9f);
  const Mesh a = make_box(a_low, a_high), b = make_box(b_low, b_high);
  for (const glm::dvec3 eye : {glm::dvec3(3, 2, 5), glm::dvec3(-4, 1, 3), glm::dvec3(1, 4, -3)}) {
    View view = look_along(eye, -eye);
    view.width = 128;
    view.height = 96;
    view.far = 100;
    const SolidProgram pa{a, view_projection(view), red}, pb{b, view_projection(view), green};
    for (const Csg op : {Csg::unite, Csg::intersect, Csg::subtract}) {
      Target target(view.width, view.height);
      DrawCounts counts;
      draw_csg(op, pa, std::span<const glm::uvec3>(a.triangles), pb, std::span<const glm::uvec3>(b.triangles), target,
               counts);
      int wrong = 0, seen[3] = {0, 0, 0};
      for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
          const PixelRay ray = pixel_ray(view, x + 0.5, y + 0.5);
          double depth = 0;
          const int expected = truth(op, slab(ray, a_low, a_high), slab(ray, b_low, b_high), depth);
          const std::uint32_t colour = at(target, x, y);
          const int drawn = colour == pack_colour(red) ? 1 : colour == pack_colour(green) ? 2 : 0;
          ++seen[drawn];
          wrong += drawn != expected ? 1 : 0;
        }
      EXPECT_LE(wrong, 12) << "operation " << static_cast<int>(op);  // centres on an edge, as far as 1/256 pixel tells
      EXPECT_GT(seen[1] + seen[2], 200);
      if (op == Csg::subtract) {
        EXPECT_LT(seen[1] + seen[2], 128 * 96 / 2);
      }
    }
  }
}

/// Where the ray meets the faces of a closed mesh, near ones first.
std::vector<double> crossings(const Mesh& mesh, const PixelRay& ray) {
  std::vector<double> t;
  for (const glm::uvec3& f : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[f.x]), ab = glm::dvec3(mesh.positions[f.y]) - a,
                                             ac = glm::dvec3(mesh.positions[f.z]) - a;
    const glm::dvec3 p = glm::cross(ray.direction, ac);
    const double det = glm::dot(ab, p);
    if (det == 0) continue;
    const glm::dvec3 from = ray.origin - a, q = glm::cross(from, ab);
    const double u = glm::dot(from, p) / det, v = glm::dot(ray.direction, q) / det;
    if (u >= 0 && v >= 0 && u + v <= 1) t.push_back(glm::dot(ac, q) / det);
  }
  std::sort(t.begin(), t.end());
  return t;
}

/// First surface of the combination along the ray: 0 nothing, 1 A, 2 B.
int first_surface(Csg op, const std::vector<double>& a, const std::vector<double>& b) {
  const auto combined = [&](bool in_a, bool in_b) {
    return op == Csg::unite ? in_a || in_b : op == Csg::intersect ? in_a && in_b : in_a && !in_b;
  };
  bool in_a = false, in_b = false;
  for (std::size_t i = 0, k = 0; i < a.size() || k < b.size();) {
    const bool of_a = k == b.size() || (i < a.size() && a[i] < b[k]);
    if (of_a)
      ++i, in_a = !in_a;
    else
      ++k, in_b = !in_b;
    if (combined(in_a, in_b)) return of_a ? 1 : 2;
  }
  return 0;
}

// 8.07 for solids that are not convex: a lattice with windows and a dented lathe, several layers deep at most pixels.
TEST(Stencil, ConstructiveSolidGeometryOfSolidsThatAreNotConvex) {
  const float lines[] = {-1.5f, -0.9f, -0.3f, 0.3f, 0.9f, 1.5f};
  std::vector<char> filled(25, 1);
  for (const int window : {6, 8, 16, 18}) filled[static_cast<std::size_t>(window)] = 0;
  const Mesh lattice = make_plate(lines, lines, filled, 1.1f);
  const glm::vec2 profile[] = {{0.9f, -1.3f}, {0.35f, -0.7f}, {1.2f, 0.1f}, {0.3f, 0.6f}, {0.8f, 1.4f}};
  const Mesh lathe = make_lathe(profile, round_section(12));
  for (const glm::dvec3 eye : {glm::dvec3(5, 1, 4), glm::dvec3(-6, 2, 0.7), glm::dvec3(0.4, -3, 6)}) {
    View view = look_along(eye, -eye);
    view.width = 160;
    view.height = 120;
    view.far = 100;
    std::size_t deepest = 0;
    int seen_by[3][3] = {};
    for (const bool swapped : {false, true}) {
      const Mesh &a = swapped ? lathe : lattice, &b = swapped ? lattice : lathe;
      const SolidProgram pa{a, view_projection(view), red}, pb{b, view_projection(view), green};
      for (const Csg op : {Csg::unite, Csg::intersect, Csg::subtract}) {
        Target target(view.width, view.height);
        DrawCounts counts;
        draw_csg(op, pa, std::span<const glm::uvec3>(a.triangles), pb, std::span<const glm::uvec3>(b.triangles), target,
                 counts);
        int wrong = 0, seen[3] = {0, 0, 0};
        for (int y = 0; y < view.height; ++y)
          for (int x = 0; x < view.width; ++x) {
            const PixelRay ray = pixel_ray(view, x + 0.5, y + 0.5);
            const auto in_a = crossings(a, ray), in_b = crossings(b, ray);
            deepest = std::max({deepest, in_a.size(), in_b.size()});
            const std::uint32_t colour = at(target, x, y);
            const int drawn = colour == pack_colour(red) ? 1 : colour == pack_colour(green) ? 2 : 0;
            ++seen[drawn];
            wrong += drawn != first_surface(op, in_a, in_b) ? 1 : 0;
          }
        EXPECT_LE(wrong, 40) << "operation " << static_cast<int>(op);  // of 19200: centres on edges
        for (const int k : {1, 2}) seen_by[static_cast<int>(op)][k] += seen[k];
      }
    }
    for (const auto& seen : seen_by) EXPECT_GT(std::min(seen[1], seen[2]), 200);
    EXPECT_GE(deepest, 4u) << "no pixel with a second layer";
  }
}

}  // namespace
}  // namespace sightline::raster
