#include "sightline/raster/scene_draw.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sightline/raster/pipeline.hpp"

namespace sightline::raster {
namespace {

/// Flat shading by the normal of the triangle, as a colour; `cost` rounds of arithmetic that do not change it.
template <ProgramKind Kind>
struct FlatProgram {
  static constexpr std::size_t varyings = 0;
  static constexpr bool discards = Kind == ProgramKind::discards, writes_depth = Kind == ProgramKind::writes_depth;
  const Mesh& mesh;
  const Affine& transform;
  glm::dmat4 to_clip;
  int cost;
  float alpha;

  [[nodiscard]] ClipVertex<0> vertex(std::uint32_t i) const {
    return {glm::vec4(to_clip * glm::dvec4(transform_point(transform, mesh.positions[i]), 1.0)), {}};
  }
  bool fragment(const Fragment<0>& in, FragmentResult& out) const {
    const glm::uvec3& t = mesh.triangles[in.triangle];
    const glm::vec3 a = transform_point(transform, mesh.positions[t.x]);
    const glm::vec3 cross = glm::cross(transform_point(transform, mesh.positions[t.y]) - a,
                                       transform_point(transform, mesh.positions[t.z]) - a);
    const float length = glm::length(cross);
    glm::vec3 n = length > 0.0f ? cross / length : glm::vec3(0, 0, 1);
    float spent = 1.0f;
    for (int i = 0; i < cost; ++i) spent = std::sqrt(spent + 0.5f * std::abs(n.x)) * 0.99f;
    n = 0.5f + 0.5f * n;
    out.colour = {n.x, n.y, n.z + (spent > 1e30f ? 1.0f : 0.0f), alpha};
    out.depth = in.z;
    return true;
  }
};

template <ProgramKind Kind>
void draw_object(const Scene& scene, ObjectId id, const glm::dmat4& to_clip, const SceneDraw& what, Target& target,
                 DrawCounts& counts) {
  const Object& object = scene.objects()[id];
  const Mesh& mesh = scene.meshes()[object.mesh];
  State state = what.state;
  if (determinant(object.transform) < 0.0f) state.front_is_ccw = !state.front_is_ccw;
  const FlatProgram<Kind> program{mesh, object.transform, to_clip, what.cost, what.alpha};
  draw(state, program, std::span<const glm::uvec3>(mesh.triangles), target, counts);
}

}  // namespace

void draw_scene(const Scene& scene, const View& view, std::span<const ObjectId> objects, const SceneDraw& what,
                Target& target, DrawCounts& counts) {
  const glm::dmat4 to_clip = view_projection(view);
  for (const ObjectId id : objects) {
    switch (what.kind) {
      case ProgramKind::plain:
        draw_object<ProgramKind::plain>(scene, id, to_clip, what, target, counts);
        break;
      case ProgramKind::discards:
        draw_object<ProgramKind::discards>(scene, id, to_clip, what, target, counts);
        break;
      case ProgramKind::writes_depth:
        draw_object<ProgramKind::writes_depth>(scene, id, to_clip, what, target, counts);
        break;
    }
  }
}

std::vector<ObjectId> front_to_back(const Scene& scene, const View& view) {
  std::vector<ObjectId> order(scene.objects().size());
  std::iota(order.begin(), order.end(), ObjectId{0});
  const glm::dvec3 forward = view_direction(view);
  std::vector<double> distance;
  for (const Object& o : scene.objects())
    distance.push_back(o.bounds.empty() ? 0.0 : glm::dot(glm::dvec3(o.bounds.centre()) - view.eye, forward));
  std::stable_sort(order.begin(), order.end(), [&](ObjectId a, ObjectId b) { return distance[a] < distance[b]; });
  return order;
}

}  // namespace sightline::raster
