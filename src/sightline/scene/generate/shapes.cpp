#include "sightline/scene/generate/shapes.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sightline/scene/generate/random.hpp"

namespace sightline {
namespace {

using Index = std::uint32_t;

void add_quad(Mesh& mesh, Index a, Index b, Index c, Index d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

// Fan over a ring of vertices; `up` tells the side it is seen from.
void add_cap(Mesh& mesh, Index first, Index count, bool up) {
  for (Index i = 1; i + 1 < count; ++i) {
    if (up)
      mesh.triangles.push_back({first, first + i, first + i + 1});
    else
      mesh.triangles.push_back({first, first + i + 1, first + i});
  }
}

// Joins two rings of `count` vertices each; a ring with `tip` is a single vertex. Outward for rings that run
// counter-clockwise as seen from the side of the upper ring.
void add_band(Mesh& mesh, Index lower, bool lower_tip, Index upper, bool upper_tip, Index count) {
  for (Index i = 0; i < count; ++i) {
    const Index j = (i + 1) % count;
    if (lower_tip && !upper_tip)
      mesh.triangles.push_back({lower, upper + j, upper + i});
    else if (!lower_tip && upper_tip)
      mesh.triangles.push_back({lower + i, lower + j, upper});
    else if (!lower_tip && !upper_tip)
      add_quad(mesh, lower + i, lower + j, upper + j, upper + i);
  }
}

}  // namespace

Mesh make_box(const glm::vec3& low, const glm::vec3& high) {
  const Aabb box{low, high};
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.positions.push_back(box.corner(i));
  add_quad(mesh, 0, 4, 6, 2);
  add_quad(mesh, 1, 3, 7, 5);
  add_quad(mesh, 0, 1, 5, 4);
  add_quad(mesh, 2, 6, 7, 3);
  add_quad(mesh, 0, 2, 3, 1);
  add_quad(mesh, 4, 5, 7, 6);
  return mesh;
}

std::vector<glm::vec2> round_section(int sides) {
  assert(sides >= 3);
  std::vector<glm::vec2> section;
  for (int i = 0; i < sides; ++i) {
    const glm::dvec2 p = circle_point((i + 0.5) / sides);
    section.emplace_back(p.x, -p.y);  // x towards -z: counter-clockwise seen from above
  }
  return section;
}

std::vector<glm::vec2> square_section() { return {{-1, 1}, {1, 1}, {1, -1}, {-1, -1}}; }

Mesh make_lathe(std::span<const glm::vec2> profile, std::span<const glm::vec2> section) {
  assert(profile.size() >= 2 && section.size() >= 3);
  const auto count = static_cast<Index>(section.size());
  Mesh mesh;
  Index previous = 0;
  for (std::size_t k = 0; k < profile.size(); ++k) {
    const auto first = static_cast<Index>(mesh.positions.size());
    const bool tip = profile[k].x == 0.0f;
    if (tip)
      mesh.positions.emplace_back(0.0f, profile[k].y, 0.0f);
    else
      for (const glm::vec2& p : section)
        mesh.positions.emplace_back(profile[k].x * p.x, profile[k].y, profile[k].x * p.y);
    if (k == 0 && !tip) add_cap(mesh, first, count, false);
    if (k > 0) add_band(mesh, previous, profile[k - 1].x == 0.0f, first, tip, count);
    if (k + 1 == profile.size() && !tip) add_cap(mesh, first, count, true);
    previous = first;
  }
  return mesh;
}

Mesh make_cylinder(int sides) {
  const glm::vec2 profile[] = {{1, 0}, {1, 1}};
  return make_lathe(profile, round_section(sides));
}

Mesh make_ball(int sides, int rings) {
  assert(rings >= 2);
  std::vector<glm::vec2> profile;
  for (int k = 0; k <= rings; ++k) {
    const glm::dvec2 p = circle_point(-0.25 + 0.5 * k / rings);
    profile.emplace_back(k == 0 || k == rings ? 0.0 : p.x, p.y);
  }
  return make_lathe(profile, round_section(sides));
}

Mesh make_gable() {
  Mesh mesh;
  mesh.positions = {{-0.5f, 0, -0.5f}, {-0.5f, 0, 0.5f}, {-0.5f, 1, 0},
                    {0.5f, 0, -0.5f},  {0.5f, 0, 0.5f},  {0.5f, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 5, 4}};
  add_quad(mesh, 0, 3, 4, 1);
  add_quad(mesh, 1, 4, 5, 2);
  add_quad(mesh, 0, 2, 5, 3);
  return mesh;
}

Mesh make_plate(std::span<const float> u, std::span<const float> v, std::span<const char> filled, float thickness) {
  const std::size_t columns = u.size() - 1, rows = v.size() - 1;
  assert(filled.size() == columns * rows);
  const std::size_t corners = u.size() * v.size();
  Mesh grid;
  for (const float z : {-0.5f * thickness, 0.5f * thickness})
    for (const float y : v)
      for (const float x : u) grid.positions.emplace_back(x, y, z);
  const auto corner = [&](std::size_t column, std::size_t row, std::size_t side) {
    return static_cast<Index>(side * corners + row * u.size() + column);
  };
  const auto solid = [&](std::size_t column, std::size_t row) {  // unsigned: below 0 is beyond the end
    return column < columns && row < rows && filled[row * columns + column] != 0;
  };
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < columns; ++c) {
      if (!solid(c, r)) continue;
      add_quad(grid, corner(c, r, 1), corner(c + 1, r, 1), corner(c + 1, r + 1, 1), corner(c, r + 1, 1));
      add_quad(grid, corner(c, r, 0), corner(c, r + 1, 0), corner(c + 1, r + 1, 0), corner(c + 1, r, 0));
      if (!solid(c - 1, r)) add_quad(grid, corner(c, r, 0), corner(c, r, 1), corner(c, r + 1, 1), corner(c, r + 1, 0));
      if (!solid(c + 1, r))
        add_quad(grid, corner(c + 1, r, 0), corner(c + 1, r + 1, 0), corner(c + 1, r + 1, 1), corner(c + 1, r, 1));
      if (!solid(c, r - 1)) add_quad(grid, corner(c, r, 0), corner(c + 1, r, 0), corner(c + 1, r, 1), corner(c, r, 1));
      if (!solid(c, r + 1))
        add_quad(grid, corner(c, r + 1, 0), corner(c, r + 1, 1), corner(c + 1, r + 1, 1), corner(c + 1, r + 1, 0));
    }
  Mesh mesh;  // without the corners that no face uses
  std::vector<Index> place(grid.positions.size(), no_object);
  for (glm::uvec3 t : grid.triangles) {
    for (int i = 0; i < 3; ++i) {
      Index& to = place[t[i]];
      if (to == no_object) {
        to = static_cast<Index>(mesh.positions.size());
        mesh.positions.push_back(grid.positions[t[i]]);
      }
      t[i] = to;
    }
    mesh.triangles.push_back(t);
  }
  return mesh;
}

Mesh make_wall(float width, float bottom, float top, float thickness, std::span<const Opening> openings) {
  std::vector<float> u{0.0f, width}, v{bottom, top};
  for (const Opening& o : openings) {
    u.insert(u.end(), {o.left, o.right});
    v.insert(v.end(), {o.bottom, o.top});
  }
  for (std::vector<float>* lines : {&u, &v}) {
    std::sort(lines->begin(), lines->end());
    lines->erase(std::unique(lines->begin(), lines->end()), lines->end());
  }
  std::vector<char> filled;
  for (std::size_t r = 0; r + 1 < v.size(); ++r)
    for (std::size_t c = 0; c + 1 < u.size(); ++c)
      filled.push_back(std::any_of(openings.begin(), openings.end(),
                                   [&](const Opening& o) {
                                     return o.left <= u[c] && u[c + 1] <= o.right && o.bottom <= v[r] &&
                                            v[r + 1] <= o.top;
                                   })
                           ? 0
                           : 1);
  return make_plate(u, v, filled, thickness);
}

Mesh make_pipe(std::span<const glm::vec3> points, float radius, int sides) {
  assert(points.size() >= 2);
  const auto direction = [&](std::size_t i) {
    return glm::normalize(glm::dvec3(points[i + 1]) - glm::dvec3(points[i]));
  };
  glm::dvec3 along = direction(0);
  // Any axis that is not along the pipe starts the frame, which then turns with the bends.
  const glm::dvec3 start = std::abs(along.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  glm::dvec3 side = glm::normalize(glm::cross(start, along));
  const std::vector<glm::vec2> section = round_section(sides);
  const auto count = static_cast<Index>(sides);
  Mesh mesh;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const glm::dvec3 before = direction(k == 0 ? 0 : k - 1);
    const glm::dvec3 after = direction(k + 1 == points.size() ? k - 1 : k);
    const glm::dvec3 mitre = glm::normalize(before + after);
    // Project the ring from the plane across `before` on to the mitre plane, along the pipe.
    side = glm::normalize(side - glm::dot(side, before) * before);
    const glm::dvec3 other = glm::cross(before, side);
    const auto first = static_cast<Index>(mesh.positions.size());
    for (const glm::vec2& p : section) {
      const glm::dvec3 offset = (side * static_cast<double>(p.x) - other * static_cast<double>(p.y)) * double(radius);
      const glm::dvec3 moved = offset - before * (glm::dot(offset, mitre) / glm::dot(before, mitre));
      mesh.positions.push_back(glm::vec3(glm::dvec3(points[k]) + moved));
    }
    if (k == 0)
      add_cap(mesh, first, count, false);
    else
      add_band(mesh, first - count, false, first, false, count);
    if (k + 1 == points.size()) add_cap(mesh, first, count, true);
    // The same point of the mitre seen from the next leg: the frame turns with the bend and does not twist.
    const glm::dvec3 on_mitre = side - before * (glm::dot(side, mitre) / glm::dot(before, mitre));
    side = on_mitre - after * glm::dot(on_mitre, after);
  }
  return mesh;
}

void append(Mesh& mesh, const Mesh& part, const Affine& transform) {
  const auto first = static_cast<Index>(mesh.positions.size());
  for (const glm::vec3& p : part.positions) mesh.positions.push_back(transform_point(transform, p));
  const bool mirrored = determinant(transform) < 0.0f;
  for (const glm::uvec3& t : part.triangles)
    mesh.triangles.push_back(mirrored ? glm::uvec3(first + t.x, first + t.z, first + t.y) : first + t);
}

double signed_volume6(const Mesh& mesh) {
  double sum = 0.0;
  for (const glm::uvec3& t : mesh.triangles)
    sum += glm::dot(glm::dvec3(mesh.positions[t.x]),
                    glm::cross(glm::dvec3(mesh.positions[t.y]), glm::dvec3(mesh.positions[t.z])));
  return sum;
}

}  // namespace sightline
