#include "gl/queries.hpp"

#include <algorithm>
#include <bit>

namespace sightline::gl {

OcclusionQueries::~OcclusionQueries() {
  if (!all_.empty()) glDeleteQueries(static_cast<GLsizei>(all_.size()), all_.data());
}

unsigned OcclusionQueries::take_name() {
  if (free_.empty()) {
    free_.resize(64);
    glGenQueries(64, free_.data());
    all_.insert(all_.end(), free_.begin(), free_.end());
  }
  const unsigned name = free_.back();
  free_.pop_back();
  return name;
}

void OcclusionQueries::issue(std::span<const Aabb> boxes, std::span<const Ask> asks, std::vector<unsigned>& names) {
  if (asks.empty()) return;
  const Timeline::Guard guard(drawing_.timeline(), 'Q', static_cast<std::uint32_t>(asks.size()));
  const GLenum target = threshold_ > 1 ? GL_SAMPLES_PASSED : GL_ANY_SAMPLES_PASSED;
  drawing_.begin_boxes(boxes);
  Work& work = drawing_.work();
  std::uint32_t first = 0;
  for (const Ask& ask : asks) {
    const unsigned name = take_name();
    glBeginQuery(target, name);
    drawing_.draw_boxes(first, ask.boxes);
    glEndQuery(target);
    first += ask.boxes;
    names.push_back(name);
    ++work.queries;
    work.multiqueries += ask.nodes > 1 ? 1 : 0;
    work.query_nodes += ask.nodes;
    ++work.query_sizes[std::min<std::size_t>(std::bit_width(std::max(ask.nodes, 1u) - 1), work.query_sizes.size() - 1)];
  }
}

bool OcclusionQueries::available(unsigned name) {
  GLuint there = 0;
  glGetQueryObjectuiv(name, GL_QUERY_RESULT_AVAILABLE, &there);
  return there != 0;
}

bool OcclusionQueries::seen(unsigned name) {
  GLuint samples = 0;
  glGetQueryObjectuiv(name, GL_QUERY_RESULT, &samples);
  free_.push_back(name);
  return samples >= threshold_;
}

bool OcclusionQueries::seen_now(unsigned name) {
  if (available(name)) return seen(name);
  ++drawing_.work().blocking_waits;
  const Timeline::Guard guard(drawing_.timeline(), 'W', 1);
  return seen(name);
}

}  // namespace sightline::gl
