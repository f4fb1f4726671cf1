#include "sightline/cull/backface.hpp"

#include "sightline/core/mesh_face_culler.hpp"
#include "sightline/geometry/face_planes.hpp"
#include "sightline/parallel/parallel.hpp"

namespace sightline {
namespace {

class Backface final : public MeshFaceCuller {
 public:
  Backface(const Scene& scene, bool scalar) : MeshFaceCuller(scene), scalar_(scalar), planes_(scene.meshes().size()) {
    parallel_blocks(planes_.size(), 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Mesh& mesh = scene.meshes()[i];
        if (solidity(static_cast<MeshId>(i)) == Solidity::solid)
          planes_[i] = make_face_planes(mesh.positions, mesh.triangles, mesh.bounds.centre());
      }
    });
  }

  [[nodiscard]] std::span<const std::uint32_t> order(MeshId) const override { return {}; }

  [[nodiscard]] std::size_t bytes() const override {
    std::size_t total = 0;
    for (const FacePlanes& planes : planes_) total += 4 * sizeof(float) * planes.x.size();
    return total;
  }

 private:
  std::size_t cull_mesh(const Object& object, const MeshEye& eye, std::span<std::uint64_t> kept,
                        Counters& counters) override {
    const FacePlanes& planes = planes_[object.mesh];
    const float slack = eye.slack + eye.sharpness / planes.extent;
    counters.faces_tested += planes.count;
    return (scalar_ ? front_faces_scalar : front_faces)(planes, eye.eye, slack, kept.data());
  }

  bool scalar_;
  std::vector<FacePlanes> planes_;  // by mesh
};

}  // namespace

std::unique_ptr<FaceCuller> make_backface(const IndexedScene& scene, ParameterReader& parameters) {
  bool scalar = false;
  parameters.read("scalar", scalar);
  parameters.finish();
  return std::make_unique<Backface>(scene.scene, scalar);
}

}  // namespace sightline
