#include "sightline/geometry/hull.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace sightline {
namespace {

double cross2(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// A face under construction: corners counter-clockwise from outside, neighbour across corner k -> k + 1.
struct Face {
  std::array<std::uint32_t, 3> corner{}, neighbour{};
  glm::dvec3 normal{0.0};
  double offset = 0.0;
  std::vector<std::uint32_t> outside;
  bool alive = true;
  int mark = 0;
};

class Quickhull {
 public:
  explicit Quickhull(std::span<const glm::vec3> points) : points_(points.begin(), points.end()) {}

  ConvexHull run() {
    glm::dvec3 lo(std::numeric_limits<double>::infinity()), hi(-lo);
    for (const glm::dvec3& p : points_) {
      lo = glm::min(lo, p);
      hi = glm::max(hi, p);
    }
    // What lies within a few roundings of float is one plane: slivers of rounding noise have no normal to go by.
    if (!points_.empty())
      epsilon_ = 4e-7 * glm::length(hi - lo) + 2e-7 * glm::length(glm::max(glm::abs(lo), glm::abs(hi)));
    if (!start()) return result_;
    for (std::size_t f = 0; f < faces_.size(); ++f)
      while (faces_[f].alive && !faces_[f].outside.empty()) add_farthest(f);
    collect();
    return result_;
  }

 private:
  double above(const Face& face, std::uint32_t p) const { return glm::dot(face.normal, points_[p]) - face.offset; }

  Face make_face(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    Face face;
    face.corner = {a, b, c};
    face.normal = glm::cross(points_[b] - points_[a], points_[c] - points_[a]);
    const double length = glm::length(face.normal);
    face.normal = length > 0.0 ? face.normal / length : glm::dvec3(0.0);
    face.offset = glm::dot(face.normal, points_[a]);
    return face;
  }

  template <class F>
  std::uint32_t largest(F&& value) const {
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i < points_.size(); ++i)
      if (value(points_[i]) > value(points_[best])) best = i;
    return best;
  }

  /// A tetrahedron; false if the points have no volume, and then the result is done.
  bool start() {
    if (points_.empty()) return false;
    const std::uint32_t a = largest([](const glm::dvec3& p) { return p.x; });
    const std::uint32_t b = largest([&](const glm::dvec3& p) { return glm::distance(p, points_[a]); });
    if (!(glm::distance(points_[a], points_[b]) > epsilon_)) {
      flat({a});
      return false;
    }
    const glm::dvec3 along = glm::normalize(points_[b] - points_[a]);
    const std::uint32_t c =
        largest([&](const glm::dvec3& p) { return glm::length(glm::cross(p - points_[a], along)); });
    if (!(glm::length(glm::cross(points_[c] - points_[a], along)) > epsilon_)) {
      // `a` need not be an end: all may have the same x.
      flat({b, largest([&](const glm::dvec3& p) { return glm::distance(p, points_[b]); })});
      return false;
    }
    const glm::dvec3 normal = glm::normalize(glm::cross(points_[b] - points_[a], points_[c] - points_[a]));
    const std::uint32_t d = largest([&](const glm::dvec3& p) { return std::abs(glm::dot(p - points_[a], normal)); });
    const double height = glm::dot(points_[d] - points_[a], normal);
    if (!(std::abs(height) > epsilon_)) {
      polygon(a, along, normal);
      return false;
    }
    const std::uint32_t e = height > 0 ? c : b, f = height > 0 ? b : c;  // a e f turns away from d
    faces_ = {make_face(a, e, f), make_face(a, f, d), make_face(f, e, d), make_face(e, a, d)};
    link();
    for (std::uint32_t i = 0; i < points_.size(); ++i) assign(i, 0);
    return true;
  }

  void flat(std::initializer_list<std::uint32_t> ends) {
    for (const std::uint32_t i : ends) result_.vertices.emplace_back(points_[i]);
    result_.slack = static_cast<float>(4.0 * epsilon_);
  }

  void polygon(std::uint32_t origin, const glm::dvec3& u, const glm::dvec3& normal) {
    const glm::dvec3 v = glm::cross(normal, u);
    std::vector<glm::dvec2> flat_points;
    for (const glm::dvec3& p : points_)
      flat_points.emplace_back(glm::dot(p - points_[origin], u), glm::dot(p - points_[origin], v));
    for (const std::uint32_t i : convex_polygon(flat_points)) result_.vertices.emplace_back(points_[i]);
    for (std::uint32_t i = 2; i < result_.vertices.size(); ++i) {
      result_.faces.push_back({0, i - 1, i});
      result_.faces.push_back({0, i, i - 1});
    }
    result_.slack = static_cast<float>(4.0 * epsilon_);
  }

  /// Neighbours of the first four faces, by their shared edges.
  void link() {
    for (std::uint32_t f = 0; f < 4; ++f)
      for (std::size_t k = 0; k < 3; ++k)
        for (std::uint32_t g = 0; g < 4; ++g)
          for (std::size_t j = 0; j < 3; ++j)
            if (faces_[f].corner[k] == faces_[g].corner[(j + 1) % 3] &&
                faces_[f].corner[(k + 1) % 3] == faces_[g].corner[j])
              faces_[f].neighbour[k] = g;
  }

  void assign(std::uint32_t point, std::size_t first_face) {
    for (std::size_t f = first_face; f < faces_.size(); ++f)
      if (faces_[f].alive && above(faces_[f], point) > epsilon_) {
        faces_[f].outside.push_back(point);
        return;
      }
  }

  /// An edge of the border between the faces that a point sees and the others: the face beyond, and its side.
  struct Border {
    std::uint32_t from, to, beyond;
  };

  /// Faces that see the point, from `face` on, depth first: the border comes out in order around it.
  void horizon(std::uint32_t start_face, std::uint32_t point, std::vector<Border>& border,
               std::vector<std::uint32_t>& seen) {
    struct Step {
      std::uint32_t face;
      std::size_t entry, next;
    };
    std::vector<Step> stack{{start_face, 0, 0}};
    faces_[start_face].mark = 1;
    seen.push_back(start_face);
    while (!stack.empty()) {
      Step& step = stack.back();
      if (step.next == 3) {
        stack.pop_back();
        continue;
      }
      const std::size_t k = (step.entry + step.next++) % 3;
      const std::uint32_t here = step.face, other = faces_[here].neighbour[k];
      if (faces_[other].mark == 1) continue;
      if (above(faces_[other], point) > epsilon_) {
        faces_[other].mark = 1;
        seen.push_back(other);
        std::size_t entry = 0;
        while (faces_[other].neighbour[entry] != here ||
               faces_[other].corner[entry] != faces_[here].corner[(k + 1) % 3])
          ++entry;
        stack.push_back({other, entry + 1, 0});
      } else {
        border.push_back({faces_[here].corner[k], faces_[here].corner[(k + 1) % 3], other});
      }
    }
  }

  void add_farthest(std::size_t f) {
    const auto farthest = std::max_element(faces_[f].outside.begin(), faces_[f].outside.end(),
                                           [&](auto a, auto b) { return above(faces_[f], a) < above(faces_[f], b); });
    const std::uint32_t point = *farthest;
    std::vector<Border> border;
    std::vector<std::uint32_t> seen;
    horizon(static_cast<std::uint32_t>(f), point, border, seen);
    const auto first = static_cast<std::uint32_t>(faces_.size()), count = static_cast<std::uint32_t>(border.size());
    for (std::uint32_t i = 0; i < count; ++i) {
      Face face = make_face(border[i].from, border[i].to, point);
      face.neighbour = {border[i].beyond, first + (i + 1) % count, first + (i + count - 1) % count};
      Face& beyond = faces_[border[i].beyond];
      for (std::size_t k = 0; k < 3; ++k)
        if (beyond.corner[k] == border[i].to && beyond.corner[(k + 1) % 3] == border[i].from)
          beyond.neighbour[k] = first + i;
      faces_.push_back(std::move(face));
    }
    for (const std::uint32_t s : seen) {
      faces_[s].alive = false;
      for (const std::uint32_t p : faces_[s].outside)
        if (p != point) assign(p, first);
      faces_[s].outside = {};
    }
  }

  void collect() {
    std::vector<std::uint32_t> number(points_.size(), 0xFFFFFFFFu);
    for (const Face& face : faces_) {
      if (!face.alive) continue;
      glm::uvec3 triangle(0u);
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& n = number[face.corner[k]];
        if (n == 0xFFFFFFFFu) {
          n = static_cast<std::uint32_t>(result_.vertices.size());
          result_.vertices.emplace_back(points_[face.corner[k]]);
        }
        triangle[static_cast<int>(k)] = n;
      }
      result_.faces.push_back(triangle);
    }
    result_.slack = static_cast<float>(8.0 * epsilon_);
    if (result_.faces.size() * points_.size() > most_checks) return;
    double outside = 0.0;  // what doubles got wrong, if anything, is made up for by the slack
    for (const Face& face : faces_)
      if (face.alive)
        for (std::uint32_t i = 0; i < points_.size(); ++i) outside = std::max(outside, above(face, i));
    result_.slack = std::max(result_.slack, static_cast<float>(2.0 * outside));
  }

  static constexpr std::size_t most_checks = 20'000'000;

  std::vector<glm::dvec3> points_;
  std::vector<Face> faces_;
  ConvexHull result_;
  double epsilon_ = 0.0;
};

}  // namespace

ConvexHull convex_hull(std::span<const glm::vec3> points) { return Quickhull(points).run(); }

std::vector<std::uint32_t> convex_polygon(std::span<const glm::dvec2> points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return points[a].x != points[b].x ? points[a].x < points[b].x : points[a].y < points[b].y;
  });
  order.erase(
      std::unique(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return points[a] == points[b]; }),
      order.end());
  if (order.size() < 3) return order;
  std::vector<std::uint32_t> hull;
  const auto chain = [&](auto begin, auto end) {
    const std::size_t base = hull.size();
    for (auto i = begin; i != end; ++i) {
      while (hull.size() >= base + 2 && cross2(points[hull[hull.size() - 2]], points[hull.back()], points[*i]) <= 0.0)
        hull.pop_back();
      hull.push_back(*i);
    }
    hull.pop_back();
  };
  chain(order.begin(), order.end());
  chain(order.rbegin(), order.rend());
  return hull;
}

double convex_area(std::span<const glm::dvec2> points) {
  const std::vector<std::uint32_t> hull = convex_polygon(points);
  double twice = 0.0;
  for (std::size_t i = 2; i < hull.size(); ++i) twice += cross2(points[hull[0]], points[hull[i - 1]], points[hull[i]]);
  return 0.5 * twice;
}

double volume(const ConvexHull& hull) {
  double six = 0.0;
  for (const glm::uvec3& f : hull.faces) {
    const glm::dvec3 o(hull.vertices[0]);
    six += glm::dot(glm::dvec3(hull.vertices[f.x]) - o,
                    glm::cross(glm::dvec3(hull.vertices[f.y]) - o, glm::dvec3(hull.vertices[f.z]) - o));
  }
  return std::max(0.0, six / 6.0);
}

double surface(const ConvexHull& hull) {
  double twice = 0.0;
  for (const glm::uvec3& f : hull.faces)
    twice += glm::length(glm::cross(glm::dvec3(hull.vertices[f.y]) - glm::dvec3(hull.vertices[f.x]),
                                    glm::dvec3(hull.vertices[f.z]) - glm::dvec3(hull.vertices[f.x])));
  return 0.5 * twice;
}

Containment classify(const Frustum& frustum, std::span<const glm::vec3> corners, float slack) {
  if (corners.empty()) return Containment::outside;
  Containment result = Containment::inside;
  for (int i = 0; i < frustum.count; ++i) {
    const Plane& plane = frustum.planes[static_cast<std::size_t>(i)];
    float most = -std::numeric_limits<float>::infinity(), least = -most;
    for (const glm::vec3& corner : corners) {
      const float distance = glm::dot(plane.normal, corner) + plane.offset;
      most = std::max(most, distance);
      least = std::min(least, distance);
    }
    if (most < -slack) return Containment::outside;
    if (least < slack) result = Containment::intersecting;
  }
  return result;
}

}  // namespace sightline
