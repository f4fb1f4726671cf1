#include "sightline/cull/cluster_backface.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "sightline/core/kept_number.hpp"
#include "sightline/core/mesh_face_culler.hpp"
#include "sightline/geometry/cluster_tree.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/generate/shapes.hpp"

namespace sightline {
namespace {

class ClusterBackface final : public MeshFaceCuller {
 public:
  ClusterBackface(const Scene& scene, const ClusterTreeConfig& config, bool scalar)
      : MeshFaceCuller(scene), scalar_(scalar), trees_(scene.meshes().size()) {
    parallel_blocks(trees_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Mesh& mesh = scene.meshes()[i];
        if (solidity(static_cast<MeshId>(i)) == Solidity::solid)
          trees_[i] = build_cluster_tree(mesh.positions, mesh.triangles, mesh.bounds.centre(), config);
      }
    });
  }

  [[nodiscard]] std::span<const std::uint32_t> order(MeshId mesh) const override { return trees_[mesh].order; }

  [[nodiscard]] std::size_t bytes() const override {
    std::size_t total = 0;
    for (const ClusterTree& tree : trees_) {
      total += sizeof(std::uint32_t) * tree.order.size();
      for (const std::vector<ClusterNode>& level : tree.levels) total += sizeof(ClusterNode) * level.size();
    }
    return total;
  }

 private:
  std::size_t cull_mesh(const Object& object, const MeshEye& eye, std::span<std::uint64_t> kept,
                        Counters& counters) override {
    ClusterCounts counts;
    (scalar_ ? front_clusters_scalar : front_clusters)(trees_[object.mesh], eye.eye, eye.slack, eye.sharpness, kept,
                                                       counts);
    counters.clusters_tested += counts.tested;
    return counts.culled;
  }

  bool scalar_;
  std::vector<ClusterTree> trees_;  // by mesh
};

/// t_C / r, between 1/64 and 64.
double measure_cluster_cost() {
  // A cluster's share of the walk over a tree of them, against what a triangle costs at least when it is not culled:
  // three corners projected and its area's sign taken. The best of several rounds, as a power of two: steady enough to
  // give the same clusters again.
  constexpr int rounds = 7;
  const auto best = [&](auto&& work) {
    double least = 1e9;
    for (int round = 0; round < rounds; ++round) {
      const auto start = std::chrono::steady_clock::now();
      volatile std::uint64_t keep = work();
      (void)keep;
      least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return std::max(least, 1e-9);
  };
  const Mesh ball = make_ball(128, 64);
  ClusterTreeConfig every;
  every.leaf = 64;
  every.cost_test = 0.0;
  const ClusterTree tree = build_cluster_tree(ball.positions, ball.triangles, glm::vec3(0.0f), every);
  std::vector<std::uint64_t> kept(ball.triangles.size() / 64 + 1);
  ClusterCounts counts;
  const double walk = best([&] {
    counts = {};
    front_clusters(tree, {3.0f, -2.0f, 5.0f, 1.0f}, 1e-6f, 0.0f, kept, counts);
    return kept[0] + counts.culled;
  });
  const double test = walk / static_cast<double>(std::max<std::uint64_t>(counts.tested, 1));
  const glm::mat4 matrix(1.2f, 0.1f, 0.3f, 0.2f, -0.1f, 1.1f, 0.2f, 0.1f, 0.2f, 0.3f, 1.0f, 0.9f, 0.0f, 0.1f, 0.5f,
                         1.0f);
  const double triangles = best([&] {
    std::uint64_t found = 0;
    for (const glm::uvec3& t : ball.triangles) {
      glm::vec2 p[3];
      for (int k = 0; k < 3; ++k) {
        const glm::vec4 q = matrix * glm::vec4(ball.positions[t[k]], 1.0f);
        p[k] = glm::vec2(q) / q.w;
      }
      found += (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x) > 0.0f ? 1 : 0;
    }
    return found;
  });
  const double triangle = triangles / static_cast<double>(ball.triangles.size());
  return std::exp2(std::round(std::log2(std::clamp(test / triangle, 1.0 / 64, 64.0))));
}

}  // namespace

double measured_cluster_cost() {
  static const double ratio = kept_number("cluster_walk_cost", 1.0 / 64, 64.0, measure_cluster_cost);
  return ratio;
}

std::unique_ptr<FaceCuller> make_cluster_backface(const IndexedScene& scene, ParameterReader& parameters) {
  ClusterTreeConfig config;
  bool scalar = false;
  double near_field = static_cast<double>(config.near_field);
  config.cost_test = 0.0;
  parameters.read("leaf", config.leaf, 1, 4096);
  parameters.read("cost", config.cost_test, 1e-3, 1e6);
  parameters.read("position", config.position, 0.0, 100.0);
  parameters.read("near_field", near_field, 1.01, 1000.0);
  parameters.read("origins", config.origins);
  parameters.read("scalar", scalar);
  parameters.finish();
  if (config.cost_test == 0.0) config.cost_test = measured_cluster_cost();
  config.near_field = static_cast<float>(near_field);
  return std::make_unique<ClusterBackface>(scene.scene, config, scalar);
}

}  // namespace sightline
