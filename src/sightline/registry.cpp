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
#include "sightline/cull/occlusion_hom.hpp"
#include "sightline/cull/occlusion_horizon.hpp"
#include "sightline/cull/occlusion_hzb.hpp"
#include "sightline/cull/occlusion_map.hpp"
#include "sightline/cull/occlusion_masked.hpp"
#include "sightline/cull/occlusion_virtual.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/surface/painter.hpp"
#include "sightline/surface/painter_bsp.hpp"
#include "sightline/surface/ray_cast.hpp"
#include "sightline/surface/whitted.hpp"
#include "sightline/surface/zbuffer.hpp"
#include "sightline/surface/zbuffer_tiled.hpp"

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
    Algorithm{"occlusion_horizon", Family::culler, cont,
              "what the walls of a city hide, below a line over plan directions", "Wonka 1999; Downs 2001",
              "21.03 21.05 21.11", make_occlusion_horizon},
    Algorithm{"occlusion_hzb", Family::culler, cont, "object boxes coarse to fine against a z-pyramid that fills up",
              "Greene 1993", "5.17 21.02 21.05-21.07 21.16 21.17", make_occlusion_hzb},
    Algorithm{"occlusion_hom", Family::culler, cont, "selected occluders as an overlap pyramid and a depth estimate",
              "Zhang 1997", "5.18 21.06 21.07", make_occlusion_hom},
    Algorithm{"occlusion_map", Family::culler, cont, "queries in batches free of overlap, after an occupancy map",
              "Staneker 2003", "22.11 22.12", make_occlusion_map},
    Algorithm{"occlusion_virtual", Family::culler, Promise::approximate,
              "boxes sampled sparsely against what was drawn", "Bartz 1999", "5.19 21.07", make_occlusion_virtual},
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
    Algorithm{"zbuffer_tiled", Family::renderer, Promise::exact, "the same, fast: screen tiles, SIMD loops, threads",
              "Strasser 1974; Catmull 1974", "3.01-3.05 3.14", nullptr, make_zbuffer_tiled},
    Algorithm{"hzb", Family::renderer, Promise::exact, "front to back, what tiles of the depth image hide left out",
              "Greene 1993", "5.01-5.04 5.07 5.10-5.12 5.17", nullptr, make_hzb},
    Algorithm{"painter", Family::renderer, Promise::approximate, "triangles sorted by depth, painted from far to near",
              "Newell 1972", "2.01-2.04", nullptr, make_painter},
    Algorithm{"painter_bsp", Family::renderer, Promise::exact,
              "painted in the order of a BSP tree, which cuts triangles", "Fuchs, Kedem and Naylor 1980",
              "2.21 15.01-15.12", nullptr, make_painter_bsp},
    Algorithm{"whitted", Family::renderer, Promise::exact, "rays with shadows, mirrors and glass; fills colour",
              "Appel 1968; Whitted 1980", "13.02 13.03", nullptr, make_whitted_row},
    Algorithm{"ray_cast", Family::renderer, Promise::exact, "per pixel the nearest triangle on a ray, by any structure",
              "Appel 1968", "13.01 13.12 13.13 14.01-14.08", nullptr, make_ray_cast},
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
  throw InputError("no " + std::string(to_string(family)) + " is called '" + std::string(name) +
                   "'; the names are: " + names);
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
