// Every renderer of the registry against the oracle, pixel by pixel: the same object, unless two surfaces lie closer
// than the stated depth error or the pixel centre lies on an edge as far as floats can tell. Those pixels are counted.
#include <gtest/gtest.h>

#include "agreement/cases.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/registry.hpp"

namespace sightline {
namespace {

struct Agreement {
  std::size_t pixels = 0, same = 0, close = 0, edge = 0, wrong = 0;
};

/// True if the object at the pixel appears within one pixel in the other image too: the centre lies on its edge.
bool appears_near(const Frame& frame, int x, int y, ObjectId id) {
  for (int ny = std::max(0, y - 1); ny <= std::min(frame.height - 1, y + 1); ++ny)
    for (int nx = std::max(0, x - 1); nx <= std::min(frame.width - 1, x + 1); ++nx)
      if (frame.object[frame.index(nx, ny)] == id) return true;
  return false;
}

/// How much the depth of the object at the pixel changes within one pixel: a surface seen almost edge-on changes by
/// more than any depth error if the eye moves by a rounding.
double steepness(const Frame& frame, int x, int y) {
  const std::size_t at = frame.index(x, y);
  double low = frame.depth[at], high = frame.depth[at];
  for (int ny = std::max(0, y - 1); ny <= std::min(frame.height - 1, y + 1); ++ny)
    for (int nx = std::max(0, x - 1); nx <= std::min(frame.width - 1, x + 1); ++nx) {
      const std::size_t near = frame.index(nx, ny);
      if (frame.object[near] != frame.object[at]) continue;
      low = std::min<double>(low, frame.depth[near]);
      high = std::max<double>(high, frame.depth[near]);
    }
  return high - low;
}

Agreement compare(const Frame& a, const Frame& b, double reach_of_scene) {
  Agreement result;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      const std::size_t at = a.index(x, y);
      ++result.pixels;
      if (a.object[at] == b.object[at]) {
        ++result.same;
        continue;
      }
      const double depth = std::min(a.depth[at], b.depth[at]);
      const double difference = std::abs(static_cast<double>(a.depth[at]) - b.depth[at]);
      if (difference <= depth_error * (depth + reach_of_scene))
        ++result.close;
      else if ((appears_near(b, x, y, a.object[at]) && appears_near(a, x, y, b.object[at])) ||
               difference <= std::max(steepness(a, x, y), steepness(b, x, y)))
        ++result.edge;
      else
        ++result.wrong;
    }
  return result;
}

TEST(RendererAgreement, IdsAreThoseOfTheOracle) {
  for (const cases::Case& c : cases::generated()) {
    // Cubes of a millimetre at five kilometres are four floats wide: whether a pixel centre hits one is not decidable.
    if (c.name.starts_with("awkward and far")) continue;
    const IndexedScene indexed = index_scene(c.scene);
    const Oracle oracle(c.scene);
    const VisibleSet all = VisibleSet::all(c.scene.objects().size());
    for (const Algorithm& row : algorithms()) {
      if (row.family != Family::renderer || row.promise != Promise::exact) continue;
      const auto renderer = make_renderer(row.name, indexed);
      Agreement total;
      for (const View& view : cases::hard_views(c.scene, 24, 4)) {
        Frame truth, frame;
        Counters counters;
        oracle.draw(view, truth);
        renderer->draw(view, all, frame, counters);
        const Agreement one = compare(frame, truth, reach(c.scene.bounds()) + glm::length(view.eye));
        EXPECT_EQ(one.wrong, 0u) << row.name << " on " << c.name << " (" << describe(view) << ")";
        total.pixels += one.pixels;
        total.close += one.close;
        total.edge += one.edge;
      }
      RecordProperty(std::string(row.name) + "_" + c.name + "_close", static_cast<int>(total.close));
      std::printf("%-10s %-14s %8zu pixels, %zu closer than the depth error, %zu on an edge\n", row.name.data(),
                  c.name.c_str(), total.pixels, total.close, total.edge);
      EXPECT_LE(total.edge * 2000, total.pixels) << row.name << " on " << c.name;
    }
  }
}

/// Almost half a turn of a view: a pixel is many degrees wide at the middle and next to nothing at the rim.
TEST(RendererAgreement, WidestViewsDifferWithinTheDepthError) {
  constexpr double degree = 3.14159265358979323846 / 180.0;
  for (const char* kind : {"building", "city", "plant", "soup"}) {
    const Scene scene = generate_scene(kind, {.objects = 300});
    const IndexedScene indexed = index_scene(scene);
    const Oracle oracle(scene);
    for (View view : cases::hard_views(scene, 8, 4)) {
      view.projection = Projection::perspective;
      view.fov_y = 179.9 * degree;
      for (const Algorithm& row : algorithms()) {
        if (row.family != Family::renderer || row.promise != Promise::exact) continue;
        Frame truth, frame;
        Counters counters;
        oracle.draw(view, truth);
        make_renderer(row.name, indexed)->draw(view, VisibleSet::all(scene.objects().size()), frame, counters);
        const Agreement one = compare(frame, truth, reach(scene.bounds()) + glm::length(view.eye));
        EXPECT_EQ(one.wrong, 0u) << row.name << " on " << kind << " (" << describe(view) << ")";
        EXPECT_LE(one.edge, 2u) << row.name << " on " << kind << " (" << describe(view) << ")";
      }
    }
  }
}

}  // namespace
}  // namespace sightline
