// What all face cullers share: the loop over objects, and who is left alone. A method adds what it does to one mesh.
#pragma once

#include "sightline/core/face_culler.hpp"
#include "sightline/scene/mesh_eye.hpp"

namespace sightline {

class MeshFaceCuller : public FaceCuller {
 public:
  /// The scene must outlive the culler.
  explicit MeshFaceCuller(const Scene& scene);

  void cull(const View& view, const VisibleSet& objects, FaceSet& kept, Counters& counters) final;
  [[nodiscard]] Solidity solidity(MeshId mesh) const final { return solidity_[mesh]; }

 protected:
  /// Told once for each view, before its meshes.
  virtual void begin(const View&) {}
  /// Sets the bits of the triangles that are kept; all are clear. Returns how many are not.
  virtual std::size_t cull_mesh(const Object& object, const MeshEye& eye, std::span<std::uint64_t> kept,
                                Counters& counters) = 0;
  [[nodiscard]] const Scene& scene() const { return scene_; }

 private:
  const Scene& scene_;
  std::vector<Solidity> solidity_;  // by mesh
};

}  // namespace sightline
