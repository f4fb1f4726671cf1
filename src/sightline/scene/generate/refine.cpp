// Splitting triangles without changing the shape: scales the triangle count of any mesh and keeps closed meshes closed.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "sightline/scene/generate/shapes.hpp"
#include "sightline/scene/topology.hpp"

namespace sightline {
namespace {

using Index = std::uint32_t;

// The points that cut every edge into n parts, made once per edge so that both neighbours use the same ones.
class EdgePoints {
 public:
  EdgePoints(std::vector<glm::vec3>& positions, Index parts) : positions_(positions), parts_(parts) {}

  // Point number i of 0 .. parts on the way from a to b.
  Index at(Index a, Index b, Index i) {
    if (i == 0) return a;
    if (i == parts_) return b;
    if (a > b) {
      std::swap(a, b);
      i = parts_ - i;
    }
    const auto [entry, fresh] = first_.try_emplace((std::uint64_t{a} << 32) | b, static_cast<Index>(positions_.size()));
    if (fresh)
      for (Index k = 1; k < parts_; ++k) {
        const float t = static_cast<float>(k) / static_cast<float>(parts_);
        positions_.push_back(positions_[a] + (positions_[b] - positions_[a]) * t);
      }
    return entry->second + i - 1;
  }

 private:
  std::vector<glm::vec3>& positions_;
  Index parts_;
  std::unordered_map<std::uint64_t, Index> first_;
};

// Every triangle into parts^2 equal ones. Vertices of equal position must be one vertex.
Mesh split_evenly(const Mesh& mesh, Index parts) {
  Mesh result;
  result.positions = mesh.positions;
  result.triangles.reserve(mesh.triangles.size() * parts * parts);
  EdgePoints edges(result.positions, parts);
  std::vector<Index> above, below;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::vec3 p = mesh.positions[t.x];
    const glm::vec3 du = mesh.positions[t.y] - p, dv = mesh.positions[t.z] - p;
    above.assign(1, t.x);
    for (Index row = 1; row <= parts; ++row) {  // rows run from edge x-y to edge x-z
      below.clear();
      for (Index i = 0; i <= row; ++i) {
        if (row == parts)
          below.push_back(edges.at(t.y, t.z, i));
        else if (i == 0)
          below.push_back(edges.at(t.x, t.y, row));
        else if (i == row)
          below.push_back(edges.at(t.x, t.z, row));
        else {
          const float n = static_cast<float>(parts);
          below.push_back(static_cast<Index>(result.positions.size()));
          result.positions.push_back(p + du * (static_cast<float>(row - i) / n) + dv * (static_cast<float>(i) / n));
        }
      }
      for (Index i = 0; i < row; ++i) {
        result.triangles.push_back({above[i], below[i], below[i + 1]});
        if (i + 1 < row) result.triangles.push_back({above[i], below[i + 1], above[i + 1]});
      }
      above.swap(below);
    }
  }
  return result;
}

// Which corner of t lies across from edge (a, b): its number 0 .. 2.
int corner_across(const glm::uvec3& t, Index a, Index b) {
  for (int i = 0; i < 3; ++i)
    if (t[i] != a && t[i] != b) return i;
  return 0;
}

// One round: bisects the longest edges, each triangle at most once, until the mesh has `wanted` triangles.
void bisect_longest(Mesh& mesh, std::size_t wanted) {
  const Topology topology = build_topology(mesh.positions, mesh.triangles);
  const auto squared_length = [&](Index e) {
    const glm::vec3 d = mesh.positions[topology.edges[e].to] - mesh.positions[topology.edges[e].from];
    return glm::dot(d, d);
  };
  std::vector<float> length(topology.edges.size());
  for (Index e = 0; e < length.size(); ++e) length[e] = squared_length(e);
  std::vector<Index> order(topology.edges.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return length[a] != length[b] ? length[a] > length[b] : a < b; });
  std::vector<char> touched(mesh.triangles.size(), 0);
  for (const Index e : order) {
    if (mesh.triangles.size() >= wanted) break;
    const MeshEdge& edge = topology.edges[e];
    if (edge.count > 2 || touched[edge.triangles[0]] || (edge.count == 2 && touched[edge.triangles[1]])) continue;
    const auto middle = static_cast<Index>(mesh.positions.size());
    mesh.positions.push_back(0.5f * (mesh.positions[edge.from] + mesh.positions[edge.to]));
    for (Index k = 0; k < edge.count; ++k) {
      const Index triangle = edge.triangles[k];
      touched[triangle] = 1;
      const glm::uvec3 t = mesh.triangles[triangle];
      const int tip = corner_across(t, edge.from, edge.to);
      const Index a = t[tip], b = t[(tip + 1) % 3], c = t[(tip + 2) % 3];
      mesh.triangles[triangle] = {a, b, middle};
      mesh.triangles.push_back({a, middle, c});
    }
  }
}

}  // namespace

Mesh refine(const Mesh& mesh, std::size_t triangles) {
  if (mesh.triangles.empty() || triangles <= mesh.triangles.size()) return mesh;
  Mesh result = mesh;
  const Topology topology = build_topology(mesh.positions, mesh.triangles);
  for (glm::uvec3& t : result.triangles)
    for (int i = 0; i < 3; ++i) t[i] = topology.welded[t[i]];
  const double ratio = static_cast<double>(triangles) / static_cast<double>(mesh.triangles.size());
  const auto parts = static_cast<Index>(std::sqrt(ratio));
  if (parts > 1) result = split_evenly(result, parts);
  while (result.triangles.size() < triangles) {
    const std::size_t before = result.triangles.size();
    bisect_longest(result, triangles);
    if (result.triangles.size() == before) break;  // nothing but edges of more than two triangles
  }
  result.name = mesh.name;
  return result;
}

}  // namespace sightline
