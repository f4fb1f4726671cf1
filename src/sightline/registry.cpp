#include "sightline/registry.hpp"

#include <array>
#include <string>

#include "sightline/cull/backface.hpp"
#include "sightline/cull/cluster_backface.hpp"
#include "sightline/cull/detail.hpp"
#include "sightline/cull/frustum_bounds.hpp"
#include "sightline/cull/frustum_hierarchical.hpp"
#include "sightline/cull/frustum_linear.hpp"
#include "sightline/cull/none.hpp"
#include "sightline/cull/normal_mask.hpp"
#include "sightline/cull/occlusion_masked.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/surface/zbuffer.hpp"

namespace sightline {
namespace {

constexpr auto cont = Promise::conservative_continuous;

constexpr Algorithm face_culler(std::string_view name, std::string_view summary, std::string_view paper,
                                std::string_view checklist,
                                std::unique_ptr<FaceCuller> (*make)(const IndexedScene&, ParameterReader&)) {
  Algorithm row{name, Family::face_culler, cont, summary, paper, checklist};
  row.make_face_culler = make;
  return row;
}

constexpr std::array rows{
    // Culling of objects.
    Algorithm{"none", Family::culler, cont, "every candidate: the trivial potentially visible set", "-", "16.01",
              make_none},
    Algorithm{"frustum_linear", Family::culler, cont, "every object's box against the planes of the frustum",
              "Clark 1976", "20.01 20.12-20.14", make_frustum_linear},
    Algorithm{"frustum_hierarchical", Family::culler, cont, "the same down a hierarchy, with plane masking",
              "Clark 1976; Bishop 1998", "20.17 20.18", make_frustum_hierarchical},
    Algorithm{"occlusion_masked", Family::culler, cont, "what large objects hide, in a small conservative depth image",
              "Hasselgren 2016", "21.02 21.05 21.06 21.09", make_occlusion_masked},
    Algorithm{"frustum_bounds", Family::culler, cont, "a bounding volume of choice against the frustum, one by one",
              "Clark 1976; Klosowski 1998", "20.02-20.06 20.10-20.16 20.19", make_frustum_bounds},
    Algorithm{"detail", Family::culler, Promise::approximate, "drops what looks smaller than so many pixels", "-",
              "26.01-26.04", make_detail},

    // Culling of faces.
    face_culler("backface", "every triangle's plane against the eye", "-", "17.01-17.09", make_backface),
    face_culler("normal_mask", "classes of normals, one bit each, looked up per triangle", "Zhang and Hoff 1997",
                "18.01-18.11", make_normal_mask),
    face_culler("cluster_backface", "a hierarchy of clusters that turn their backs or faces as one",
                "Johannsen and Carter 1998; Kumar 1996", "19.01-19.17", make_cluster_backface),

    // Visible surfaces.
    Algorithm{"zbuffer", Family::renderer, Promise::exact, "per pixel the nearest surface, every triangle drawn",
              "Strasser 1974; Catmull 1974", "3.01-3.05 3.11", nullptr, make_zbuffer},
};

}  // namespace

std::span<const Algorithm> algorithms() { return rows; }

const Algorithm& find_algorithm(std::string_view name, Family family) {
  std::string names;
  for (const Algorithm& row : rows) {
    if (row.family != family) continue;
    if (row.name == name) return row;
    names += (names.empty() ? "" : ", ") + std::string(row.name);
  }
  throw InputError("no " + std::string(to_string(family)) + " is called '" + std::string(name) + "'; there are " +
                   names);
}

std::unique_ptr<Culler> make_culler(std::string_view text, const IndexedScene& scene) {
  const MethodSpec spec = parse_method(text);
  ParameterReader reader(spec);
  return find_algorithm(spec.name, Family::culler).make_culler(scene, reader);
}

std::unique_ptr<Renderer> make_renderer(std::string_view text, const IndexedScene& scene) {
  const MethodSpec spec = parse_method(text);
  ParameterReader reader(spec);
  return find_algorithm(spec.name, Family::renderer).make_renderer(scene, reader);
}

std::unique_ptr<FaceCuller> make_face_culler(std::string_view text, const IndexedScene& scene) {
  const MethodSpec spec = parse_method(text);
  ParameterReader reader(spec);
  return find_algorithm(spec.name, Family::face_culler).make_face_culler(scene, reader);
}

}  // namespace sightline
