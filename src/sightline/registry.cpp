#include "sightline/registry.hpp"

#include <array>
#include <string>

#include "sightline/cull/frustum_hierarchical.hpp"
#include "sightline/cull/frustum_linear.hpp"
#include "sightline/cull/none.hpp"
#include "sightline/cull/occlusion_masked.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/surface/painter.hpp"
#include "sightline/surface/painter_bsp.hpp"
#include "sightline/surface/whitted.hpp"
#include "sightline/surface/zbuffer.hpp"

namespace sightline {
namespace {

constexpr auto cont = Promise::conservative_continuous;

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

    // Visible surfaces.
    Algorithm{"zbuffer", Family::renderer, Promise::exact, "per pixel the nearest surface, every triangle drawn",
              "Strasser 1974; Catmull 1974", "3.01-3.05 3.11", nullptr, make_zbuffer},
    Algorithm{"painter", Family::renderer, Promise::approximate, "triangles sorted by depth, painted from far to near",
              "Newell 1972", "2.01-2.04", nullptr, make_painter},
    Algorithm{"painter_bsp", Family::renderer, Promise::exact,
              "painted in the order of a BSP tree, which cuts triangles", "Fuchs, Kedem and Naylor 1980",
              "2.21 15.01-15.12", nullptr, make_painter_bsp},
    Algorithm{"whitted", Family::renderer, Promise::exact, "rays with shadows, mirrors and glass; fills colour",
              "Appel 1968; Whitted 1980", "13.02 13.03", nullptr, make_whitted_row},
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

}  // namespace sightline
