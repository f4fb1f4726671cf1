#include "gl/registry.hpp"

#include <array>
#include <string>

#include "gl/chc.hpp"
#include "gl/chcpp.hpp"
#include "gl/conditional.hpp"
#include "gl/device_culling.hpp"
#include "gl/flat_queries.hpp"
#include "gl/frustum_method.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline::gl {
namespace {

constexpr auto promise = Promise::conservative;

constexpr Algorithm row(std::string_view name, std::string_view summary, std::string_view paper,
                        std::string_view checklist) {
  return {name, Family::culler, promise, summary, paper, checklist};
}

constexpr std::array rows{
    GlAlgorithm{row("gl_frustum", "draws all that the frustum holds, in a chosen order: the baseline", "Clark 1976",
                    "4.09 21.16 21.17"),
                make_frustum},
    GlAlgorithm{row("gl_optimal", "draws exactly what is seen, told beforehand: the bound", "-", "21.15"),
                make_optimal},
    GlAlgorithm{row("gl_stop_and_wait", "query, wait, draw or cull, down the hierarchy", "-", "22.03-22.05 22.07"),
                make_stop_and_wait},
    GlAlgorithm{row("gl_draw_and_wait", "some occluders, then one bundle of queries for all the rest", "-", "22.06"),
                make_draw_and_wait},
    GlAlgorithm{row("gl_multiple_queries", "bundles of queries front to back, one wait for each", "-", "22.09 22.10"),
                make_multiple_queries},
    GlAlgorithm{
        row("gl_overlap_free", "bundles of objects that do not overlap on the screen", "Staneker 2003", "22.11 22.12"),
        make_overlap_free},
    GlAlgorithm{row("gl_chc", "coherent hierarchical culling: visible stays visible, nobody waits", "Bittner 2004",
                    "22.20 22.21 22.26"),
                make_chc},
    GlAlgorithm{row("gl_chcpp", "the same with batches, multiqueries, assumed visibility and tight bounds",
                    "Mattausch 2008", "22.13-22.19 22.22 22.23 23.01 23.06-23.09 24.01-24.07"),
                make_chcpp},
    GlAlgorithm{row("gl_conditional", "the device itself skips what its query found hidden", "-", "22.03"),
                make_conditional},
    GlAlgorithm{row("gl_hzb", "two-phase, boxes against a pyramid of depths, all on the device",
                    "Haar 2015; Greene 1993", "22.04"),
                make_hzb},
    GlAlgorithm{row("gl_raster", "two-phase, boxes whose fragments write what is seen", "Boudier 2013", "22.04"),
                make_raster},
};

}  // namespace

std::span<const GlAlgorithm> algorithms() { return rows; }

const GlAlgorithm* find_algorithm(std::string_view name) {
  for (const GlAlgorithm& algorithm : rows)
    if (algorithm.row.name == name) return &algorithm;
  return nullptr;
}

std::unique_ptr<Method> make_method(std::string_view text, SceneDrawing& drawing) {
  const MethodSpec spec = parse_method(text);
  const GlAlgorithm* algorithm = find_algorithm(spec.name);
  if (algorithm == nullptr) {
    std::string names;
    for (const GlAlgorithm& other : rows) names += (names.empty() ? "" : ", ") + std::string(other.row.name);
    throw InputError("no OpenGL method is called '" + spec.name + "'; there are " + names);
  }
  ParameterReader reader(spec);
  return algorithm->make(drawing, reader);
}

MethodCuller::MethodCuller(std::shared_ptr<SceneDrawing> drawing, std::string_view text)
    : drawing_(std::move(drawing)), method_(make_method(text, *drawing_)) {}

void MethodCuller::cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) {
  drawing_->context().make_current();
  const Work before = work_;
  drawing_->set_work(&work_);
  drawing_->set_timeline(timeline_);
  method_->prepare(view, &candidates);
  method_->frame(view, target_, &candidates);
  method_->drawn(drawn_);
  drawing_->set_work(nullptr);
  drawing_->set_timeline(nullptr);
  visible.reset(candidates.universe());
  for (const ObjectId id : drawn_)
    if (candidates.contains(id)) visible.insert(id);
  counters.nodes_visited += work_.nodes - before.nodes;
  counters.queries += work_.queries - before.queries;
  counters.triangles_in += work_.triangles - before.triangles;
}

}  // namespace sightline::gl
