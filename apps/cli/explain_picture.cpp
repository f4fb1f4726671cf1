#include <algorithm>
#include <cmath>

#include "explain.hpp"

namespace sightline::cli {
namespace {

constexpr glm::vec3 seen_colour{0.15f, 0.80f, 0.30f}, outline_colour{1.0f, 0.10f, 0.75f},
    edge_colour{0.95f, 0.15f, 0.1f};

/// From orange to yellow: occluders in the order of what they cover.
glm::vec3 cover_colour(std::size_t rank) {
  const float t = std::min(1.0f, static_cast<float>(rank) / 6.0f);
  return glm::mix(glm::vec3(1.0f, 0.40f, 0.05f), glm::vec3(0.95f, 0.85f, 0.35f), t);
}

class Painter {
 public:
  Painter(Picture& picture, const Explanation& why) : picture_(picture), why_(why) {}

  void tint(int x, int y, const glm::vec3& colour, float strength) {
    for (int channel = 0; channel < 3; ++channel) {
      std::uint8_t& byte = picture_.rgb[index(x, y) * 3 + static_cast<std::size_t>(channel)];
      byte = static_cast<std::uint8_t>(
          std::lround(glm::mix(static_cast<float>(byte), colour[channel] * 255.0f, strength)));
    }
  }

  void tint_objects(const Frame& frame) {
    for (int y = 0; y < picture_.height; ++y)
      for (int x = 0; x < picture_.width; ++x) {
        const ObjectId id = frame.object[frame.index(x, y)];
        if (id == why_.object) {
          tint(x, y, seen_colour, 0.7f);
          continue;
        }
        const auto cover =
            std::find_if(why_.covers.begin(), why_.covers.end(), [&](const Cover& c) { return c.object == id; });
        if (id != no_object && cover != why_.covers.end())
          tint(x, y, cover_colour(static_cast<std::size_t>(cover - why_.covers.begin())), 0.6f);
      }
  }

  /// The rim of what the object would cover alone; where no sample hits it, the rim of its box.
  void outline() {
    if (why_.area.empty()) return;
    const bool box = why_.alone_samples == 0;
    const int n = why_.samples_per_axis, thick = std::max(1, picture_.height / 360);
    if (box && !why_.box_pixels) return;
    for (int y = why_.area.y0 / n; y < (why_.area.y1 + n - 1) / n; ++y)
      for (int x = why_.area.x0 / n; x < (why_.area.x1 + n - 1) / n; ++x)
        if (box ? on_rim_of_area(x, y) : on_rim(x, y, thick)) tint(x, y, outline_colour, 1.0f);
  }

  /// A bar at the side of the image beyond which the object lies; a frame all around for near and far.
  void edge() {
    if (!why_.plane) return;
    const std::string_view name = why_.plane->name;
    const int thick = std::max(2, picture_.height / 60), right = picture_.width - thick, low = picture_.height - thick;
    const bool all = name == "near" || name == "far";
    for (int y = 0; y < picture_.height; ++y)
      for (int x = 0; x < picture_.width; ++x)
        if (((all || name == "left") && x < thick) || ((all || name == "right") && x >= right) ||
            ((all || name == "top") && y < thick) || ((all || name == "bottom") && y >= low))
          tint(x, y, edge_colour, 0.9f);
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(picture_.width) + static_cast<std::size_t>(x);
  }

  /// Does the object alone cover the middle sample of a pixel?
  [[nodiscard]] bool covers(int x, int y) const {
    const int n = why_.samples_per_axis, sx = x * n + n / 2, sy = y * n + n / 2;
    const SampleRect& area = why_.area;
    if (sx < area.x0 || sx >= area.x1 || sy < area.y0 || sy >= area.y1) return false;
    return why_.alone[static_cast<std::size_t>(sy - area.y0) * static_cast<std::size_t>(area.x1 - area.x0) +
                      static_cast<std::size_t>(sx - area.x0)];
  }

  [[nodiscard]] bool on_rim(int x, int y, int thick) const {
    if (!covers(x, y)) return false;
    for (int dy = -thick; dy <= thick; ++dy)
      for (int dx = -thick; dx <= thick; ++dx)
        if (!covers(x + dx, y + dy)) return true;
    return false;
  }

  [[nodiscard]] bool on_rim_of_area(int x, int y) const {
    const int n = why_.samples_per_axis;
    const SampleRect& area = why_.area;
    return x == area.x0 / n || y == area.y0 / n || x == (area.x1 - 1) / n || y == (area.y1 - 1) / n;
  }

  Picture& picture_;
  const Explanation& why_;
};

}  // namespace

Picture explanation_picture(const Scene& scene, const View& view, const Frame& frame, const Explanation& why) {
  Picture picture = paint(scene, view, frame, Show::shaded);
  Painter painter(picture, why);
  painter.tint_objects(frame);
  painter.outline();
  painter.edge();
  return picture;
}

}  // namespace sightline::cli
