// What a frame cost: counts, and the timeline of drawing, querying and results (checklist 22.08).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace sightline::gl {

struct Work {
  std::uint64_t frames = 0;
  std::uint64_t nodes = 0;           // nodes of the hierarchy visited by the processor
  std::uint64_t queries = 0;         // occlusion queries issued (tests, where visibility is written by shaders)
  std::uint64_t multiqueries = 0;    // of these: for more than one node
  std::uint64_t query_nodes = 0;     // nodes asked about, over all queries
  std::uint64_t query_boxes = 0;     // boxes drawn for queries
  std::uint64_t state_changes = 0;   // switches between drawing and querying
  std::uint64_t blocking_waits = 0;  // times the processor waited for a result that it needed at once
  std::uint64_t draw_calls = 0;      // of scene geometry
  std::uint64_t objects = 0;         // drawn
  std::uint64_t triangles = 0;       // drawn
  std::array<std::uint64_t, 8> query_sizes{};  // queries for 1, 2, 3-4, 5-8, ... nodes
};

enum class Lane { processor, device };

/// A piece of a frame: D drawing, Q querying, R reading results, W waiting for one.
struct Span {
  char kind = 'D';
  Lane lane = Lane::processor;
  std::uint32_t frame = 0;
  std::uint32_t count = 0;        // objects drawn, queries issued or results read
  double begin = 0.0, end = 0.0;  // microseconds on the clock of its lane, from the first frame on
};

}  // namespace sightline::gl
