#include "sightline/raster/occlusion_clip.hpp"

#include <array>

#include "sightline/raster/occlusion_kernels.hpp"

namespace sightline::raster {
namespace {

/// (x, y, w, h): pixel = centre + (x, y) / h, w the distance; h is w for perspective views and 1 for orthographic ones.
using Point = glm::dvec4;

constexpr int planes = 5;         // near, then the four sides of the guard band
constexpr int most_corners = 20;  // convex polygons need 8; noise may make more

struct Polygon {
  std::array<Point, most_corners> corners;
  int count = 0;
  void add(const Point& p) { corners[static_cast<std::size_t>(count++)] = p; }
  [[nodiscard]] const Point& operator[](int i) const { return corners[static_cast<std::size_t>(i)]; }
};

Point to_clip(const ClipTransform& t, const glm::vec3& position) {
  const glm::dvec3 p = t.rows * glm::dvec3(position) + t.offset;
  return {p.x, p.y, p.z, t.perspective ? p.z : 1.0};
}

/// >= 0 inside. The near plane moves inwards by rounding.
double side(const ClipTransform& t, int plane, const Point& p) {
  switch (plane) {
    case 0:
      return p.z - (t.near + std::abs(t.near) * 1e-5);
    case 1:
      return t.guard * p.w - p.x;
    case 2:
      return t.guard * p.w + p.x;
    case 3:
      return t.guard * p.w - p.y;
    default:
      return t.guard * p.w + p.y;
  }
}

struct Projected {
  float x, y, near;
};
Projected project(const ClipTransform& t, const Point& p) {
  return {static_cast<float>(t.centre.x + p.x / p.w), static_cast<float>(t.centre.y + p.y / p.w),
          static_cast<float>(t.perspective ? 1.0 / p.z : -p.z)};
}

/// Clips a contour segment at the planes from `first` on, and appends what is left.
void append_edge(const ClipTransform& t, Point a, Point b, int first, DrawList& out) {
  for (int plane = first; plane < planes; ++plane) {
    const double da = side(t, plane, a), db = side(t, plane, b);
    if (da < 0 && db < 0) return;
    if (da < 0) a = b + (a - b) * (db / (db - da));
    if (db < 0) b = a + (b - a) * (da / (da - db));
  }
  out.reserve(0, 1);
  const Projected p = project(t, a), q = project(t, b);
  out.edge_x[0][out.edges] = p.x;
  out.edge_y[0][out.edges] = p.y;
  out.edge_x[1][out.edges] = q.x;
  out.edge_y[1][out.edges] = q.y;
  out.edge_near[0][out.edges] = p.near;
  out.edge_near[1][out.edges] = q.near;
  ++out.edges;
}

}  // namespace

double clip_facing(const ClipTransform& t, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const Point p = to_clip(t, a), q = to_clip(t, b), r = to_clip(t, c);
  return -glm::dot(glm::dvec3(p.x, p.y, p.w), glm::cross(glm::dvec3(q.x, q.y, q.w), glm::dvec3(r.x, r.y, r.w)));
}

void clip_triangle(const ClipTransform& t, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, DrawList& out) {
  Polygon polygon;
  for (const glm::vec3& p : {a, b, c}) polygon.add(to_clip(t, p));
  for (int plane = 0; plane < planes && polygon.count > 0; ++plane) {
    Polygon inside, cut;
    for (int i = 0; i < polygon.count; ++i) {
      const Point &p = polygon[i], &q = polygon[(i + 1) % polygon.count];
      const double dp = side(t, plane, p), dq = side(t, plane, q);
      if (dp >= 0) inside.add(p);
      if ((dp >= 0) == (dq >= 0)) continue;
      const Point crossing = p + (q - p) * (dp / (dp - dq));
      inside.add(crossing);
      cut.add(crossing);
    }
    polygon = inside;
    if (plane == 0 && cut.count == 2) append_edge(t, cut[0], cut[1], 1, out);
  }
  for (int i = 2; i < polygon.count; ++i) {
    out.reserve(1, 0);
    const Point* corners[3] = {&polygon[0], &polygon[i - 1], &polygon[i]};
    for (std::size_t k = 0; k < 3; ++k) {
      const Projected p = project(t, *corners[k]);
      out.x[k][out.triangles] = p.x;
      out.y[k][out.triangles] = p.y;
      out.near[k][out.triangles] = p.near;
    }
    ++out.triangles;
  }
}

void clip_edge(const ClipTransform& t, const glm::vec3& a, const glm::vec3& b, DrawList& out) {
  append_edge(t, to_clip(t, a), to_clip(t, b), 0, out);
}

}  // namespace sightline::raster
