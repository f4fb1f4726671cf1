// What the work was: counts that are part of every result. Zero where an algorithm has no such work.
#pragma once

#include <cstdint>

namespace sightline {

struct Counters {
  std::uint64_t nodes_visited = 0;       // nodes of a space partition
  std::uint64_t boxes_tested = 0;        // bounds tested against the frustum
  std::uint64_t corner_rejects = 0;      // bounds that the planes let pass and the box around the frustum does not
  std::uint64_t queries = 0;             // bounds tested for occlusion
  std::uint64_t queries_saved = 0;       // bounds that a cheaper test found visible before a query
  std::uint64_t query_batches = 0;       // groups of queries that wait for each other's drawing
  std::uint64_t cells_tested = 0;        // cells of an image pyramid, columns or samples looked at by queries
  std::uint64_t occluders = 0;           // objects drawn as occluders
  std::uint64_t occluder_triangles = 0;  // triangles of those objects, before any culling
  std::uint64_t triangles_in = 0;        // triangles given to a renderer
  std::uint64_t triangles_filled = 0;    // triangles that reached the fill loop
  std::uint64_t pixels_tested = 0;       // depth tests
  std::uint64_t pixels_written = 0;      // depth writes
  std::uint64_t faces_tested = 0;        // triangles whose orientation was tested one by one
  std::uint64_t faces_culled = 0;        // triangles found to turn their backs
  std::uint64_t clusters_tested = 0;     // clusters of triangles whose orientation was tested
  std::uint64_t rays = 0;                // rays traced
  std::uint64_t ray_triangle_tests = 0;  // rays tested against triangles

  /// Calls f(name, value) for every counter, in order.
  template <class F>
  void each(F&& f) const {
    f("nodes_visited", nodes_visited);
    f("boxes_tested", boxes_tested);
    f("corner_rejects", corner_rejects);
    f("queries", queries);
    f("queries_saved", queries_saved);
    f("query_batches", query_batches);
    f("cells_tested", cells_tested);
    f("occluders", occluders);
    f("occluder_triangles", occluder_triangles);
    f("triangles_in", triangles_in);
    f("triangles_filled", triangles_filled);
    f("pixels_tested", pixels_tested);
    f("pixels_written", pixels_written);
    f("faces_tested", faces_tested);
    f("faces_culled", faces_culled);
    f("clusters_tested", clusters_tested);
    f("rays", rays);
    f("ray_triangle_tests", ray_triangle_tests);
  }
};

}  // namespace sightline
