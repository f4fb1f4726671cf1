// Shared edges and closedness: cubes whole, open, split and flipped, a Moebius strip, edges of more than two triangles.
#include "sightline/scene/topology.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

#include "properties.hpp"
#include "scene/shapes.hpp"

namespace sightline {
namespace {

Topology topology_of(const Mesh& mesh) { return build_topology(mesh.positions, mesh.triangles); }

TEST(Topology, CubeIsClosed) {
  const Topology topology = topology_of(shapes::cube());
  EXPECT_EQ(topology.edges.size(), 18u);  // Euler: 8 - 18 + 12 = 2
  EXPECT_TRUE(is_closed(topology));
  for (const MeshEdge& edge : topology.edges) {
    EXPECT_LT(edge.from, edge.to);
    EXPECT_EQ(edge.count, 2u);
    EXPECT_EQ(edge.forward, 1u);
    EXPECT_NE(edge.triangles[0], edge.triangles[1]);
  }
}

TEST(Topology, SplitVerticesAreWelded) {
  const Topology topology = topology_of(shapes::split_vertices(shapes::cube()));
  EXPECT_EQ(topology.edges.size(), 18u);
  EXPECT_TRUE(is_closed(topology));
}

TEST(Topology, NegativeZeroIsZero) {
  Mesh mesh = shapes::split_vertices(shapes::cube());
  for (std::size_t i = 0; i < mesh.positions.size(); i += 2)
    for (int axis = 0; axis < 3; ++axis)
      if (mesh.positions[i][axis] == 0.0f) mesh.positions[i][axis] = -0.0f;
  EXPECT_TRUE(is_closed(topology_of(mesh)));
}

TEST(Topology, ClosednessNeedsNoTopology) {
  Mesh mesh = shapes::split_vertices(shapes::cube());
  EXPECT_TRUE(is_closed(mesh.positions, mesh.triangles));
  EXPECT_FALSE(is_closed(mesh.positions, std::span(mesh.triangles).first(11)));
  std::swap(mesh.triangles[5].y, mesh.triangles[5].z);
  EXPECT_FALSE(is_closed(mesh.positions, mesh.triangles));
  EXPECT_FALSE(is_closed({}, {}));
}

/// More edges at one vertex than are sorted by insertion.
TEST(Topology, DoublePyramidOverManyCornersIsClosed) {
  Mesh mesh;
  constexpr std::uint32_t corners = 5000;
  mesh.positions = {{0, 1, 0}, {0, -1, 0}};
  for (std::uint32_t i = 0; i < corners; ++i) {
    const float angle = 6.2831853f * static_cast<float>(i) / corners;
    mesh.positions.emplace_back(std::cos(angle), 0, std::sin(angle));
    const std::uint32_t a = 2 + i, b = 2 + (i + 1) % corners;
    mesh.triangles.push_back({0, b, a});
    mesh.triangles.push_back({1, a, b});
  }
  EXPECT_TRUE(is_closed(mesh.positions, mesh.triangles));
  EXPECT_EQ(topology_of(mesh).edges.size(), 3 * corners);
  mesh.triangles.pop_back();
  EXPECT_FALSE(is_closed(mesh.positions, mesh.triangles));
}

TEST(Topology, CubeWithoutOneTriangleIsOpen) {
  Mesh mesh = shapes::cube();
  mesh.triangles.pop_back();
  const Topology topology = topology_of(mesh);
  EXPECT_FALSE(is_closed(topology));
  EXPECT_EQ(std::count_if(topology.edges.begin(), topology.edges.end(), [](const MeshEdge& e) { return e.count == 1; }),
            3);
}

TEST(Topology, OneFlippedTriangleIsNotClosed) {
  Mesh mesh = shapes::cube();
  std::swap(mesh.triangles[5].y, mesh.triangles[5].z);
  EXPECT_FALSE(is_closed(topology_of(mesh)));
}

TEST(Topology, InsideOutIsClosedToo) {
  Mesh mesh = shapes::cube();
  for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
  EXPECT_TRUE(is_closed(topology_of(mesh)));
}

TEST(Topology, MoebiusStripIsNotClosed) {
  const Topology topology = topology_of(shapes::moebius_strip(12));
  EXPECT_FALSE(is_closed(topology));
  const auto boundary =
      std::count_if(topology.edges.begin(), topology.edges.end(), [](const MeshEdge& e) { return e.count == 1; });
  EXPECT_EQ(boundary, 24);
  const auto inconsistent = std::count_if(topology.edges.begin(), topology.edges.end(),
                                          [](const MeshEdge& e) { return e.count == 2 && e.forward != 1; });
  EXPECT_EQ(inconsistent, 1) << "the seam";
}

TEST(Topology, CubesThatShareAnEdgeAreNotClosed) {
  Mesh mesh = shapes::cube();
  const auto n = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::uint32_t i = 0; i < n; ++i) mesh.positions.push_back(mesh.positions[i] + glm::vec3(1, 1, 0));
  const std::size_t triangles = mesh.triangles.size();
  for (std::size_t t = 0; t < triangles; ++t) mesh.triangles.push_back(mesh.triangles[t] + n);
  const Topology topology = topology_of(mesh);
  EXPECT_FALSE(is_closed(topology));
  EXPECT_EQ(topology.edges.size(), 35u);  // twice 18, one of them common
  EXPECT_EQ(std::count_if(topology.edges.begin(), topology.edges.end(),
                          [](const MeshEdge& e) { return e.count == 4 && e.forward == 2; }),
            1);
}

TEST(Topology, DegenerateTrianglesContributeNothing) {
  Mesh mesh = shapes::cube();
  mesh.triangles.push_back({0, 0, 1});
  mesh.positions.push_back(mesh.positions[3]);
  mesh.triangles.push_back({3, 8, 1});  // two vertices at one place
  const Topology topology = topology_of(mesh);
  EXPECT_TRUE(is_closed(topology));
  EXPECT_EQ(topology.edges.size(), 18u);
  EXPECT_EQ(topology.triangle_edges[12], glm::uvec3(no_triangle));
  EXPECT_EQ(topology.triangle_edges[13], glm::uvec3(no_triangle));
}

TEST(Topology, NothingIsNotClosed) {
  EXPECT_FALSE(is_closed(build_topology({}, {})));
  Mesh mesh = shapes::cube();
  mesh.triangles = {{0, 0, 0}};
  EXPECT_FALSE(is_closed(topology_of(mesh)));
}

RC_GTEST_PROP(TopologyProperty, EveryEdgeIsCountedWhereItIs, ()) {
  // Vertices on a small grid, so that many coincide.
  Mesh mesh;
  const int vertices = *rc::gen::inRange(1, 20);
  for (int i = 0; i < vertices; ++i)
    mesh.positions.push_back(glm::vec3(*rc::gen::inRange(0, 2), *rc::gen::inRange(0, 2), *rc::gen::inRange(0, 2)));
  const int triangles = *rc::gen::inRange(0, 30);
  for (int i = 0; i < triangles; ++i)
    mesh.triangles.push_back(
        {*rc::gen::inRange(0, vertices), *rc::gen::inRange(0, vertices), *rc::gen::inRange(0, vertices)});
  const Topology topology = topology_of(mesh);

  RC_ASSERT(is_closed(mesh.positions, mesh.triangles) == is_closed(topology));
  RC_ASSERT(topology.welded.size() == mesh.positions.size());
  for (std::uint32_t i = 0; i < mesh.positions.size(); ++i) {
    RC_ASSERT(topology.welded[i] <= i);
    for (std::uint32_t j = 0; j < mesh.positions.size(); ++j)
      RC_ASSERT((mesh.positions[i] == mesh.positions[j]) == (topology.welded[i] == topology.welded[j]));
  }
  RC_ASSERT(std::is_sorted(topology.edges.begin(), topology.edges.end(), [](const MeshEdge& a, const MeshEdge& b) {
    return std::tie(a.from, a.to) < std::tie(b.from, b.to);
  }));
  std::vector<std::uint32_t> count(topology.edges.size(), 0), forward(topology.edges.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int side = 0; side < 3; ++side) {
      const std::uint32_t e = topology.triangle_edges[t][side];
      if (e == no_triangle) continue;
      const std::uint32_t a = topology.welded[mesh.triangles[t][side]];
      const std::uint32_t b = topology.welded[mesh.triangles[t][(side + 1) % 3]];
      RC_ASSERT(topology.edges[e].from == std::min(a, b));
      RC_ASSERT(topology.edges[e].to == std::max(a, b));
      ++count[e];
      forward[e] += a < b ? 1u : 0u;
    }
  for (std::size_t e = 0; e < count.size(); ++e) {
    RC_ASSERT(topology.edges[e].count == count[e]);
    RC_ASSERT(topology.edges[e].forward == forward[e]);
  }
}

}  // namespace
}  // namespace sightline
