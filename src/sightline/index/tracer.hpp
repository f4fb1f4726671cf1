// The tracing structures behind one interface, by name: for tools that compare them. Engines use the structure itself
// (bvh8.hpp and its neighbours), which costs no virtual call.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "sightline/geometry/frustum.hpp"
#include "sightline/index/trace.hpp"

namespace sightline {

/// Any number of threads may ask at once.
class Tracer {
 public:
  virtual ~Tracer() = default;
  Tracer() = default;
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  /// The nearest triangle: smallest t, then lowest place in the soup.
  virtual RayHit nearest(const Ray& ray, TraceCounters& counters) const = 0;
  /// True if any triangle is met.
  virtual bool any(const Ray& ray, TraceCounters& counters) const = 0;
  /// Places of the triangles that touch the box / the frustum; ascending.
  [[nodiscard]] virtual std::vector<std::uint32_t> in_box(const Aabb& box) const = 0;
  [[nodiscard]] virtual std::vector<std::uint32_t> in_frustum(const Frustum& frustum) const = 0;
  /// Memory of the structure, without the soup unless it replaces it.
  [[nodiscard]] virtual std::size_t bytes() const = 0;
  /// Repeats the tests that a trace of this ray appended to TraceCounters::tested, and nothing else.
  [[nodiscard]] virtual RayHit retest(const Ray& ray, std::span<const std::uint32_t> tested) const = 0;
};

struct TracerKind {
  std::string_view name;
  std::string_view summary;  // one line
  /// The soup must outlive the tracer.
  std::unique_ptr<Tracer> (*make)(const TriangleSoup& soup);
};

/// The fastest first; "brute" last.
std::span<const TracerKind> tracer_kinds();

/// Null if there is none of that name.
const TracerKind* find_tracer(std::string_view name);

}  // namespace sightline
