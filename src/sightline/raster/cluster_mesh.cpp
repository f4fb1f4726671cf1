#include "sightline/raster/cluster_mesh.hpp"

#include <algorithm>
#include <array>

namespace sightline::raster {
namespace {

template <class T>
void pad(std::vector<T>& values, std::size_t to, T value) {
  values.resize((values.size() + to - 1) / to * to, value);
}

class Builder {
 public:
  explicit Builder(const Mesh& mesh) : mesh_(mesh), slot_(mesh.positions.size(), no_slot) {}

  ClusterMesh build() {
    std::uint32_t first = 0;
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (t - first == cluster_triangles || used_.size() + missing(mesh_.triangles[t]) > cluster_vertices) {
        finish(first, t);
        first = t;
      }
      for (int k = 0; k < 3; ++k) take(mesh_.triangles[t][k]);
    }
    if (first < mesh_.triangles.size()) finish(first, static_cast<std::uint32_t>(mesh_.triangles.size()));
    // Loops read whole vectors; what lies beyond the last cluster must be no box and no triangle.
    for (auto* low : {&out_.low_x, &out_.low_y, &out_.low_z}) low->resize(low->size() + cluster_padding, 0.0f);
    for (auto* high : {&out_.high_x, &out_.high_y, &out_.high_z}) high->resize(high->size() + cluster_padding, 0.0f);
    for (auto* index : {&out_.a, &out_.b, &out_.c}) index->resize(index->size() + cluster_padding, 0);
    return std::move(out_);
  }

 private:
  static constexpr std::uint32_t no_slot = 0xFFFFFFFFu;

  [[nodiscard]] std::size_t missing(const glm::uvec3& t) const {
    std::size_t count = 0;
    for (int k = 0; k < 3; ++k) count += slot_[t[k]] == no_slot ? 1 : 0;
    return count;
  }
  void take(std::uint32_t vertex) {
    if (slot_[vertex] != no_slot) return;
    slot_[vertex] = static_cast<std::uint32_t>(used_.size());
    used_.push_back(vertex);
  }

  void finish(std::uint32_t first, std::uint32_t end) {
    Cluster cluster{first, end - first, static_cast<std::uint32_t>(out_.x.size()),
                    static_cast<std::uint32_t>(used_.size()), static_cast<std::uint32_t>(out_.a.size())};
    Aabb box;
    for (const std::uint32_t v : used_) {
      const glm::vec3& p = mesh_.positions[v];
      out_.x.push_back(p.x);
      out_.y.push_back(p.y);
      out_.z.push_back(p.z);
      box.extend(p);
    }
    for (auto* axis : {&out_.x, &out_.y, &out_.z}) pad(*axis, cluster_padding, axis->back());
    for (std::uint32_t t = first; t < end; ++t) {
      const glm::uvec3& v = mesh_.triangles[t];
      out_.a.push_back(static_cast<std::uint8_t>(slot_[v.x]));
      out_.b.push_back(static_cast<std::uint8_t>(slot_[v.y]));
      out_.c.push_back(static_cast<std::uint8_t>(slot_[v.z]));
    }
    for (auto* index : {&out_.a, &out_.b, &out_.c}) pad(*index, cluster_padding, std::uint8_t{0});
    out_.low_x.push_back(box.lo.x);
    out_.low_y.push_back(box.lo.y);
    out_.low_z.push_back(box.lo.z);
    out_.high_x.push_back(box.hi.x);
    out_.high_y.push_back(box.hi.y);
    out_.high_z.push_back(box.hi.z);
    out_.bounds.extend(box);
    out_.clusters.push_back(cluster);
    for (const std::uint32_t v : used_) slot_[v] = no_slot;
    used_.clear();
  }

  const Mesh& mesh_;
  std::vector<std::uint32_t> slot_, used_;
  ClusterMesh out_;
};

}  // namespace

ClusterMesh make_clusters(const Mesh& mesh) { return Builder(mesh).build(); }

}  // namespace sightline::raster
