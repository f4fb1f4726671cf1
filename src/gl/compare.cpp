#include "gl/compare.hpp"

#include <bit>

namespace sightline::gl {

void Comparison::draw_all(const View& view, bool in_frustum) {
  Work* const unused = nullptr;
  drawing_.set_work(unused);
  drawing_.begin(view, target_);
  drawn_.clear();
  if (in_frustum) {
    std::vector<Placed> found;
    objects_in_frustum(drawing_, nullptr, false, found);
    for (const Placed& placed : found) drawn_.push_back(placed.id);
  } else {
    for (ObjectId id = 0; id < drawing_.scene().objects().size(); ++id) drawn_.push_back(id);
  }
  drawing_.draw(drawn_);
  drawing_.resolve_ties(drawn_);
  target_.read_back(view, reference_);
  drawing_.context().check("drawing everything");
}

std::uint64_t Comparison::differing_pixels(Method& method, const View& view) {
  method.prepare(view, nullptr);
  method.frame(view, target_);
  method.drawn(drawn_);
  drawing_.resolve_ties(drawn_);
  target_.read_back(view, picture_);
  std::uint64_t differing = 0;
  for (std::size_t i = 0; i < reference_.object.size(); ++i)
    differing +=
        reference_.object[i] != picture_.object[i] || reference_.colour[i] != picture_.colour[i] ||
                std::bit_cast<std::uint32_t>(reference_.depth[i]) != std::bit_cast<std::uint32_t>(picture_.depth[i])
            ? 1
            : 0;
  return differing;
}

}  // namespace sightline::gl
