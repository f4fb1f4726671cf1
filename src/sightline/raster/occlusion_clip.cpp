#include "sightline/raster/occlusion_clip.hpp"

#include <array>
#include <vector>

namespace sightline::raster {
namespace {

/// (x, y, w, h): pixel = centre + (x, y) / h, w the distance; h is w for perspective views and 1 for orthographic ones.
using Point = glm::dvec4;

class Clipper {
 public:
  Clipper(const OccluderMesh& mesh, const ClipTransform& t, const Margins& margins, const Kernels& kernels,
          Tiles& tiles, FillCounts& counts)
      : mesh_(mesh), t_(t), margins_(margins), kernels_(kernels), tiles_(tiles), counts_(counts) {
    // Inside where dot >= 0 after the constant; the near plane moves inwards by rounding.
    near_ = t.near + std::abs(t.near) * 1e-5;
    points_.reserve(mesh.vertex_count);
    for (std::size_t i = 0; i < mesh.vertex_count; ++i) {
      const glm::dvec3 p = t.rows * glm::dvec3(mesh.x[i], mesh.y[i], mesh.z[i]) + t.offset;
      points_.emplace_back(p.x, p.y, p.z, t.perspective ? p.z : 1.0);
    }
  }

  void draw(bool mirrored) {
    facing_.assign(mesh_.triangle_count + 2, 0.0);
    for (std::size_t i = 0; i < mesh_.triangle_count; ++i) facing_[i] = facing(i, mirrored);
    draw_side(1.0);
    if (!mesh_.closed) draw_side(-1.0);
  }

 private:
  static constexpr int planes = 5;  // near, then the four sides of the guard band

  void draw_side(double sign) {
    facing_[mesh_.triangle_count + 1] = sign;
    for (std::size_t c = 0; c + 1 < mesh_.triangle_begin.size(); ++c) {
      for (std::size_t i = mesh_.triangle_begin[c]; i < mesh_.triangle_begin[c + 1]; ++i)
        if (facing_[i] * sign > 0)
          draw_triangle(corner(mesh_.corner0, i), corner(mesh_.corner1, i), corner(mesh_.corner2, i));
      for (std::size_t e = mesh_.edge_begin[c]; e < mesh_.edge_begin[c + 1]; ++e)
        if (is_contour(e, sign)) mark(corner(mesh_.edge_from, e), corner(mesh_.edge_to, e), 0);
      kernels_.commit(tiles_);
    }
  }

  /// > 0 front, < 0 back, 0 without area; as in the kernels.
  [[nodiscard]] double facing(std::size_t i, bool mirrored) const {
    const double area = signed_area(corner(mesh_.corner0, i), corner(mesh_.corner1, i), corner(mesh_.corner2, i));
    return mirrored ? area : -area;
  }

  [[nodiscard]] const Point& corner(const std::vector<std::int32_t>& list, std::size_t i) const {
    return points_[static_cast<std::size_t>(list[i])];
  }

  /// Twice the area in the image up to a positive factor (Olano and Greer 1997): right even behind the eye.
  static double signed_area(const Point& a, const Point& b, const Point& c) {
    return glm::dot(glm::dvec3(a.x, a.y, a.w), glm::cross(glm::dvec3(b.x, b.y, b.w), glm::dvec3(c.x, c.y, c.w)));
  }

  [[nodiscard]] bool is_contour(std::size_t e, double sign) const {
    const bool first = facing_[static_cast<std::size_t>(mesh_.edge_first[e])] * sign > 0;
    const bool second = facing_[static_cast<std::size_t>(mesh_.edge_second[e])] * sign > 0;
    return (first || second) && !(first && second && mesh_.edge_winding[e] > 0);
  }

  [[nodiscard]] double side(int plane, const Point& p) const {
    switch (plane) {
      case 0:
        return p.z - near_;
      case 1:
        return t_.guard * p.w - p.x;
      case 2:
        return t_.guard * p.w + p.x;
      case 3:
        return t_.guard * p.w - p.y;
      default:
        return t_.guard * p.w + p.y;
    }
  }

  void draw_triangle(const Point& a, const Point& b, const Point& c) {
    polygon_.assign({a, b, c});
    for (int plane = 0; plane < planes && !polygon_.empty(); ++plane) {
      clipped_.clear();
      cut_.clear();
      for (std::size_t i = 0; i < polygon_.size(); ++i)
        clip_edge(plane, polygon_[i], polygon_[(i + 1) % polygon_.size()]);
      polygon_.swap(clipped_);
      if (plane == 0 && cut_.size() == 2) mark(cut_[0], cut_[1], 1);
    }
    for (std::size_t i = 2; i < polygon_.size(); ++i) {
      const std::array<ScreenPoint, 3> corners{project(polygon_[0]), project(polygon_[i - 1]), project(polygon_[i])};
      kernels_.fill_triangle(corners.data(), margins_, tiles_, counts_);
    }
  }

  void clip_edge(int plane, const Point& a, const Point& b) {
    const double da = side(plane, a), db = side(plane, b);
    if (da >= 0) clipped_.push_back(a);
    if ((da >= 0) == (db >= 0)) return;
    const Point crossing = a + (b - a) * (da / (da - db));
    clipped_.push_back(crossing);
    cut_.push_back(crossing);
  }

  /// Clips a contour segment at the planes from `first` on, and marks what is left.
  void mark(Point a, Point b, int first) {
    for (int plane = first; plane < planes; ++plane) {
      const double da = side(plane, a), db = side(plane, b);
      if (da < 0 && db < 0) return;
      if (da < 0) a = b + (a - b) * (db / (db - da));
      if (db < 0) b = a + (b - a) * (da / (da - db));
    }
    kernels_.mark_contour(project(a), project(b), margins_, tiles_, counts_);
  }

  [[nodiscard]] ScreenPoint project(const Point& p) const {
    return {static_cast<float>(t_.centre.x + p.x / p.w), static_cast<float>(t_.centre.y + p.y / p.w),
            static_cast<float>(t_.perspective ? 1.0 / p.z : -p.z)};
  }

  const OccluderMesh& mesh_;
  const ClipTransform& t_;
  const Margins& margins_;
  const Kernels& kernels_;
  Tiles& tiles_;
  FillCounts& counts_;
  double near_;
  std::vector<Point> points_, polygon_, clipped_, cut_;
  std::vector<double> facing_;
};

}  // namespace

void draw_clipped(const OccluderMesh& mesh, const ClipTransform& transform, bool mirrored, const Margins& margins,
                  const Kernels& kernels, Tiles& tiles, FillCounts& counts) {
  Clipper(mesh, transform, margins, kernels, tiles, counts).draw(mirrored);
}

}  // namespace sightline::raster
