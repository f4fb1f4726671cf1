#include "sightline/scene/solid.hpp"

#include <cmath>
#include <numeric>

#include "sightline/scene/topology.hpp"

namespace sightline {
namespace {

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/// For every triangle a number that is the same for triangles connected by edges.
std::vector<std::uint32_t> connected_parts(const Topology& topology, std::size_t triangles) {
  std::vector<std::uint32_t> parent(triangles);
  std::iota(parent.begin(), parent.end(), 0u);
  for (const MeshEdge& edge : topology.edges)
    if (edge.count == 2) parent[root_of(parent, edge.triangles[0])] = root_of(parent, edge.triangles[1]);
  for (std::uint32_t t = 0; t < triangles; ++t) parent[t] = root_of(parent, t);
  return parent;
}

}  // namespace

Solidity solidity_of(const Mesh& mesh) {
  if (!mesh.closed) return Solidity::open;
  const std::vector<std::uint32_t> part =
      connected_parts(build_topology(mesh.positions, mesh.triangles), mesh.triangles.size());
  std::vector<double> volume(mesh.triangles.size(), 0.0), size(mesh.triangles.size(), 0.0);
  const glm::dvec3 origin(mesh.bounds.centre());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& v = mesh.triangles[t];
    const glm::dvec3 a = glm::dvec3(mesh.positions[v.x]) - origin, b = glm::dvec3(mesh.positions[v.y]) - origin,
                     c = glm::dvec3(mesh.positions[v.z]) - origin;
    const double six = glm::dot(a, glm::cross(b, c));
    volume[part[t]] += six;
    size[part[t]] += std::abs(six);
  }
  for (std::size_t t = 0; t < volume.size(); ++t)
    if (volume[t] < -1e-9 * size[t]) return Solidity::inverted;
  return Solidity::solid;
}

std::string_view to_string(Solidity solidity) {
  return solidity == Solidity::solid ? "solid" : solidity == Solidity::open ? "open" : "inverted";
}

}  // namespace sightline
