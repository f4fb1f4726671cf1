// The A-buffer (Carpenter 1984; checklist 7.09) reduced to what transparency needs: all fragments of every pixel,
// sorted by depth and blended in exact order. The reference for sorted transparency. Promise: exact order per pixel;
// fragments of equal depth in the order of drawing.
#pragma once

#include <algorithm>
#include <vector>

#include "sightline/raster/pipeline.hpp"

namespace sightline::raster {

class ABuffer {
 public:
  struct Entry {
    float z;
    glm::vec4 colour;
  };

  ABuffer(int width, int height)
      : width_(width), pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

  void add(int x, int y, const Entry& entry) { pixels_[index(x, y)].push_back(entry); }
  [[nodiscard]] std::size_t layers(int x, int y) const { return pixels_[index(x, y)].size(); }

  /// Blends the fragments in front of the target's depth over its colour, farthest first. Colours are kept in floats
  /// until the end, so only one rounding to 8 bits happens.
  void resolve(const Blend& blend, Target& target) {
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      auto& entries = pixels_[i];
      if (entries.empty()) continue;
      std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.z > b.z; });
      glm::vec4 colour = unpack_colour(target.colour[i]);
      for (const Entry& e : entries)
        if (depth_code(target.format, static_cast<double>(e.z)) < target.depth[i])
          colour = blended(blend, e.colour, colour);
      target.colour[i] = pack_colour(colour);
    }
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  int width_;
  std::vector<std::vector<Entry>> pixels_;
};

/// A program whose fragments go into an A-buffer instead of the image; draw it with all writes masked.
template <class Program>
struct Collected {
  static constexpr std::size_t varyings = Program::varyings;
  static constexpr bool discards = true, writes_depth = false;
  const Program& program;
  ABuffer& buffer;
  [[nodiscard]] ClipVertex<varyings> vertex(std::uint32_t i) const { return program.vertex(i); }
  bool fragment(const Fragment<varyings>& in, FragmentResult& out) const {
    if (program.fragment(in, out)) buffer.add(in.x, in.y, {in.z, out.colour});
    return false;
  }
};

}  // namespace sightline::raster
