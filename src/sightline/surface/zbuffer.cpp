#include "sightline/surface/zbuffer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace sightline {
namespace {

/// A corner in the image: pixels from the top left, and what is affine in the image (E5): 1 / distance for perspective
/// views, the distance itself for orthographic ones.
struct Corner {
  double x, y, z;
};

/// Edge function of a -> b: positive on the side where a clockwise (as seen, y down) triangle has its inside.
double edge(const Corner& a, const Corner& b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

/// Top-left rule in an image with y down and triangles wound so that edge() is positive inside: a point on a top edge
/// (horizontal, inside below) or a left edge (running up) belongs to the triangle.
bool owns_border(const Corner& a, const Corner& b) { return b.y < a.y || (b.y == a.y && b.x > a.x); }

/// Both neighbours of an edge must see the same number up to the sign: evaluate from the lower end point on.
double shared_edge(const Corner& a, const Corner& b, double x, double y) {
  const bool swap = b.x < a.x || (b.x == a.x && b.y < a.y);
  return swap ? -edge(b, a, x, y) : edge(a, b, x, y);
}

class ZBuffer final : public Renderer {
 public:
  ZBuffer(const Scene& scene, bool overdraw) : scene_(scene), overdraw_(overdraw) {}

  void draw(const View& view, const VisibleSet& visible, Frame& frame, Counters& counters) override {
    frame.clear(view.width, view.height);
    if (overdraw_) frame.writes.assign(frame.depth.size(), 0);
    perspective_ = view.projection == Projection::perspective;
    const glm::dmat4 to_view = view_matrix(view);
    const double aspect = static_cast<double>(view.width) / view.height;
    scale_y_ = perspective_ ? 0.5 * view.height / std::tan(0.5 * view.fov_y) : view.height / view.span_y;
    scale_x_ =
        perspective_ ? 0.5 * view.width / (std::tan(0.5 * view.fov_y) * aspect) : view.width / (view.span_y * aspect);
    centre_ = {0.5 * view.width, 0.5 * view.height};
    for (const ObjectId id : visible.order()) draw_object(view, to_view, id, frame, counters);
  }

 private:
  void draw_object(const View& view, const glm::dmat4& to_view, ObjectId id, Frame& frame, Counters& counters) {
    const Object& object = scene_.objects()[id];
    const Mesh& mesh = scene_.meshes()[object.mesh];
    corners_.clear();
    for (const glm::vec3& p : mesh.positions)
      corners_.push_back(glm::dvec3(to_view * glm::dvec4(transform_point(object.transform, p), 1.0)));
    counters.triangles_in += mesh.triangles.size();
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const glm::uvec3& v = mesh.triangles[t];
      draw_triangle(view, {corners_[v.x], corners_[v.y], corners_[v.z]}, id, t, frame, counters);
    }
  }

  /// Clips at near and far plane, then fills the resulting fan.
  void draw_triangle(const View& view, const std::array<glm::dvec3, 3>& triangle, ObjectId id, std::uint32_t t,
                     Frame& frame, Counters& counters) {
    const auto by_distance = [](const glm::dvec3& a, const glm::dvec3& b) { return -a.z < -b.z; };
    const auto [nearest, farthest] = std::minmax_element(triangle.begin(), triangle.end(), by_distance);
    if (-farthest->z < view.near || -nearest->z > view.far) return;
    polygon_.assign(triangle.begin(), triangle.end());
    if (-nearest->z < view.near) clip(-1.0, -view.near);
    if (-farthest->z > view.far) clip(1.0, view.far);
    for (std::size_t i = 2; i < polygon_.size(); ++i)
      fill({project(polygon_[0]), project(polygon_[i - 1]), project(polygon_[i])}, id, t, frame, counters);
  }

  /// Keeps the part of polygon_ with sign * z + offset >= 0 (view space). Crossings are computed from the kept end on,
  /// so that neighbours agree (Sutherland and Hodgman 1974).
  void clip(double sign, double offset) {
    clipped_.clear();
    for (std::size_t i = 0; i < polygon_.size(); ++i) {
      const glm::dvec3& a = polygon_[i];
      const glm::dvec3& b = polygon_[(i + 1) % polygon_.size()];
      const double da = sign * a.z + offset, db = sign * b.z + offset;
      if (da >= 0) clipped_.push_back(a);
      if ((da >= 0) != (db >= 0)) {
        const glm::dvec3& in = da >= 0 ? a : b;
        const glm::dvec3& out = da >= 0 ? b : a;
        const double t = std::max(da, db) / std::abs(da - db);
        clipped_.push_back(in + t * (out - in));
      }
    }
    polygon_.swap(clipped_);
  }

  [[nodiscard]] Corner project(const glm::dvec3& p) const {
    const double w = perspective_ ? 1.0 / -p.z : 1.0;
    return {centre_.x + scale_x_ * p.x * w, centre_.y - scale_y_ * p.y * w, perspective_ ? w : -p.z};
  }

  void fill(std::array<Corner, 3> c, ObjectId id, std::uint32_t t, Frame& frame, Counters& counters) const {
    double area = edge(c[0], c[1], c[2].x, c[2].y);
    if (!(area != 0.0) || !std::isfinite(area)) return;
    if (area < 0) {
      std::swap(c[1], c[2]);
      area = -area;
    }
    const auto [min_x, max_x] = std::minmax({c[0].x, c[1].x, c[2].x});
    const auto [min_y, max_y] = std::minmax({c[0].y, c[1].y, c[2].y});
    const int x0 = static_cast<int>(std::clamp(std::ceil(min_x - 0.5), 0.0, static_cast<double>(frame.width)));
    const int x1 = static_cast<int>(std::clamp(std::floor(max_x - 0.5) + 1, 0.0, static_cast<double>(frame.width)));
    const int y0 = static_cast<int>(std::clamp(std::ceil(min_y - 0.5), 0.0, static_cast<double>(frame.height)));
    const int y1 = static_cast<int>(std::clamp(std::floor(max_y - 0.5) + 1, 0.0, static_cast<double>(frame.height)));
    if (x0 >= x1 || y0 >= y1) return;
    ++counters.triangles_filled;
    std::array<bool, 3> border{};
    for (std::size_t e = 0; e < 3; ++e) border[e] = owns_border(c[e], c[(e + 1) % 3]);
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        const double px = x + 0.5, py = y + 0.5;
        std::array<double, 3> weight{};  // of the corner opposite to the edge
        bool inside = true;
        for (std::size_t e = 0; e < 3 && inside; ++e) {
          const double value = shared_edge(c[e], c[(e + 1) % 3], px, py);
          inside = value > 0 || (value == 0 && border[e]);
          weight[(e + 2) % 3] = value;
        }
        if (inside) test(c, weight, x, y, id, t, frame, counters);
      }
  }

  /// Depth test and write; LESS, equal depth goes to the lower ids.
  void test(const std::array<Corner, 3>& c, const std::array<double, 3>& weight, int x, int y, ObjectId id,
            std::uint32_t t, Frame& frame, Counters& counters) const {
    const double z =
        (weight[0] * c[0].z + weight[1] * c[1].z + weight[2] * c[2].z) / (weight[0] + weight[1] + weight[2]);
    const auto depth = static_cast<float>(perspective_ ? 1.0 / z : z);
    const std::size_t at = frame.index(x, y);
    ++counters.pixels_tested;
    const bool tie =
        depth == frame.depth[at] && (id < frame.object[at] || (id == frame.object[at] && t < frame.triangle[at]));
    if (!(depth < frame.depth[at]) && !tie) return;
    ++counters.pixels_written;
    if (overdraw_) ++frame.writes[at];
    frame.depth[at] = depth;
    frame.object[at] = id;
    frame.triangle[at] = t;
  }

  const Scene& scene_;
  bool overdraw_;
  bool perspective_ = true;
  double scale_x_ = 1.0, scale_y_ = 1.0;
  glm::dvec2 centre_{0.0};
  std::vector<glm::dvec3> corners_, polygon_, clipped_;
};

}  // namespace

std::unique_ptr<Renderer> make_zbuffer(const IndexedScene& scene, ParameterReader& parameters) {
  bool overdraw = false;
  parameters.read("overdraw", overdraw);
  parameters.finish();
  return std::make_unique<ZBuffer>(scene.scene, overdraw);
}

}  // namespace sightline
