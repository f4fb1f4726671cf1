// sightline boolean: union, intersection or difference of two scenes as solids, written as one object.
#include <fmt/format.h>

#include "json_output.hpp"
#include "query_options.hpp"
#include "scene_argument.hpp"
#include "sightline/index/bsp_boolean.hpp"
#include "sightline/raster/scene_polygons.hpp"
#include "sightline/scene/save/glb.hpp"

namespace sightline::cli {
namespace {

BooleanOp operation_of(const std::string& name) {
  if (name == "union") return BooleanOp::unite;
  if (name == "intersection") return BooleanOp::intersect;
  if (name == "difference") return BooleanOp::subtract;
  throw UsageError("no operation is called '" + name + "'; there are union, intersection, difference");
}

PolygonSet solid_of(const std::string& text, const CommonOptions& common) {
  const LoadedScene loaded = open_scene(text, common);
  for (ObjectId id = 0; id < loaded.scene.objects().size(); ++id)
    if (!loaded.scene.mesh_of(id).closed)
      throw InputError(text, fmt::format("object {} '{}'", id, loaded.scene.name(id)), "does not bound a closed solid");
  PolygonSet set = scene_polygons(loaded.scene, 2'000'000, "boolean").polygons;
  if (enclosed_volume(set) < 0.0) throw InputError(text, "", "the faces of the solid point inwards");
  return set;
}

Scene scene_of(const PolygonSet& polygons) {
  Mesh mesh;
  mesh.name = "solid";
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    const std::span<const glm::dvec3> corners = polygons[i];
    for (const glm::dvec3& p : corners) mesh.positions.emplace_back(p);
    for (std::uint32_t k = 2; k < corners.size(); ++k) mesh.triangles.push_back({base, base + k - 1, base + k});
  }
  SceneBuilder builder;
  if (!mesh.triangles.empty()) builder.add_object(builder.add_mesh(std::move(mesh)), identity_affine(), "solid");
  return builder.build();
}

}  // namespace

int run_boolean(const BooleanOptions& options) {
  const BooleanOp op = operation_of(options.operation);
  JsonOutput output(options.common);
  const PolygonSet a = solid_of(options.first, options.common), b = solid_of(options.second, options.common);
  const BooleanResult result = boolean_of(a, b, op);
  const Scene scene = scene_of(result.polygons);
  save_glb(scene, options.output);
  const double volumes[3] = {enclosed_volume(a), enclosed_volume(b), enclosed_volume(result.polygons)};
  if (options.common.prints())
    fmt::print("{}: {} triangles; {:.6g} m3 and {:.6g} m3 give {:.6g} m3\n", options.output, scene.triangle_count(),
               volumes[0], volumes[1], volumes[2]);
  output.write({{"schema", "sightline.boolean/1"},
                {"output", options.output},
                {"operation", options.operation},
                {"polygons", result.polygons.size()},
                {"triangles", scene.triangle_count()},
                {"volume_first", volumes[0]},
                {"volume_second", volumes[1]},
                {"volume", volumes[2]}});
  return exit_ok;
}

}  // namespace sightline::cli
