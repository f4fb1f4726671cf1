#include "sightline/core/mesh_face_culler.hpp"

#include "sightline/parallel/parallel.hpp"

namespace sightline {

MeshFaceCuller::MeshFaceCuller(const Scene& scene) : scene_(scene), solidity_(scene.meshes().size()) {
  parallel_blocks(solidity_.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) solidity_[i] = solidity_of(scene.meshes()[i]);
  });
}

void MeshFaceCuller::cull(const View& view, const VisibleSet& objects, FaceSet& kept, Counters& counters) {
  kept.clear();
  begin(view);
  for (const ObjectId id : objects.order()) {
    const Object& object = scene_.objects()[id];
    const Mesh& mesh = scene_.meshes()[object.mesh];
    MeshEye eye;
    if (object.opaque && solidity_[object.mesh] == Solidity::solid) eye = mesh_eye(view, object, mesh);
    const std::span<std::uint64_t> bits = kept.add(id, mesh.triangles.size(), !eye.valid);
    if (!eye.valid) continue;
    counters.faces_culled += cull_mesh(object, eye, bits, counters);
  }
}

}  // namespace sightline
