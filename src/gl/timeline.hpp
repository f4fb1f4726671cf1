// The timeline of frames: what processor and device did when (checklist 22.07, 22.08), kept as plain spans.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "gl/work.hpp"

namespace sightline::gl {

/// Collects spans. The device's times are asked for at the end of a frame, as asking earlier would wait.
class Timeline {
 public:
  Timeline();
  ~Timeline();
  Timeline(const Timeline&) = delete;
  Timeline& operator=(const Timeline&) = delete;

  /// Begins a frame; spans of the device of the frame before are collected.
  void frame();
  /// A span of kind D, Q, R or W from the construction of the returned guard to its end, on the processor and, for D
  /// and Q, on the device.
  class Guard {
   public:
    Guard(Timeline* timeline, char kind, std::uint32_t count);
    ~Guard();
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;

   private:
    Timeline* timeline_;
    Span span_;
    unsigned stamps_[2] = {0, 0};
  };
  /// All spans so far; waits for the device.
  const std::vector<Span>& spans();

 private:
  friend class Guard;
  struct Pending {
    Span span;
    unsigned stamps[2];
  };
  [[nodiscard]] double now() const;
  unsigned stamp();
  void collect();
  std::chrono::steady_clock::time_point start_;
  std::int64_t device_start_ = 0;
  std::uint32_t frame_ = 0;
  bool any_frame_ = false;
  std::vector<Span> spans_;
  std::vector<Pending> pending_;
  std::vector<unsigned> free_;
};

/// The spans as a trace that chrome://tracing and Perfetto show: one row for the processor, one for the device.
std::string chrome_trace(const std::vector<Span>& spans, const std::string& name);

/// One frame as an SVG picture: a row for the processor, one for the device; D drawing, Q querying, R results, W waits.
std::string timeline_svg(const std::vector<Span>& spans, std::uint32_t frame, const std::string& name);

}  // namespace sightline::gl
