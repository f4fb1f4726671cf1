#include "sightline/surface/painter.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "sightline/index/bsp.hpp"
#include "sightline/raster/polygon_fill.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

enum class Key { farthest, centroid, nearest };

/// A triangle in view space. Distances are along the view direction.
struct Item {
  std::array<glm::dvec3, 3> corners;
  double key, nearest, farthest;
  ObjectId object;
  std::uint32_t triangle;
};

/// Far ones first; of equal ones the lower ids last, so that they stay.
bool paints_before(const Item& a, const Item& b) {
  if (a.key != b.key) return a.key > b.key;
  if (a.object != b.object) return a.object > b.object;
  return a.triangle > b.triangle;
}

class Painter final : public Renderer {
 public:
  Painter(const Scene& scene, Key key, bool split, std::size_t most_fragments)
      : scene_(scene), key_(split ? Key::farthest : key), split_(split), most_fragments_(most_fragments) {}

  void draw(const View& view, const VisibleSet& visible, Frame& frame, Counters& counters) override {
    frame.clear(view.width, view.height);  // the background is painted first
    const ImageMap map(view);
    items_.clear();
    for (const ObjectId id : visible.order()) collect(map, id, counters);
    std::sort(items_.begin(), items_.end(), paints_before);
    if (split_)
      paint_groups(map, frame, counters);
    else
      for (const Item& item : items_)
        if (fill_.set(map, item.corners)) paint(item, frame, counters);
  }

 private:
  void collect(const ImageMap& map, ObjectId id, Counters& counters) {
    const Object& object = scene_.objects()[id];
    const Mesh& mesh = scene_.meshes()[object.mesh];
    points_.clear();
    for (const glm::vec3& p : mesh.positions)
      points_.push_back(map.view_point(glm::dvec3(transform_point(object.transform, p))));
    counters.triangles_in += mesh.triangles.size();
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const glm::uvec3& v = mesh.triangles[t];
      Item item{{points_[v.x], points_[v.y], points_[v.z]}, 0.0, 0.0, 0.0, id, t};
      const auto [low, high] = std::minmax({-item.corners[0].z, -item.corners[1].z, -item.corners[2].z});
      if (high < map.near || low > map.far) continue;
      item.nearest = low;
      item.farthest = high;
      item.key = key_ == Key::farthest  ? high
                 : key_ == Key::nearest ? low
                                        : -(item.corners[0].z + item.corners[1].z + item.corners[2].z) / 3.0;
      items_.push_back(item);
    }
  }

  void paint(const Item& item, Frame& frame, Counters& counters) const {
    ++counters.triangles_filled;
    fill_.fill([&](int x, int y, float depth) {
      const std::size_t at = frame.index(x, y);
      ++counters.pixels_written;
      frame.depth[at] = depth;
      frame.object[at] = item.object;
      frame.triangle[at] = item.triangle;
    });
  }

  /// Runs of triangles whose depth intervals overlap one another are cut until they sort (2.02): each run in the order
  /// of a BSP tree of its own. Runs do not overlap in depth and need no cutting.
  void paint_groups(const ImageMap& map, Frame& frame, Counters& counters) {
    for (std::size_t begin = 0, end = 0; begin < items_.size(); begin = end) {
      double nearest = items_[begin].nearest;
      for (end = begin + 1; end < items_.size() && items_[end].farthest >= nearest; ++end)
        nearest = std::min(nearest, items_[end].nearest);
      paint_group(map, begin, end, frame, counters);
    }
  }

  void paint_group(const ImageMap& map, std::size_t begin, std::size_t end, Frame& frame, Counters& counters) {
    // Ascending ids, as ties in a plane want them.
    std::sort(items_.begin() + static_cast<std::ptrdiff_t>(begin), items_.begin() + static_cast<std::ptrdiff_t>(end),
              [](const Item& a, const Item& b) {
                return a.object != b.object ? a.object < b.object : a.triangle < b.triangle;
              });
    PolygonSet polygons;
    for (std::size_t i = begin; i < end; ++i) polygons.add(items_[i].corners);
    BspConfig config;
    config.most_fragments = most_fragments_;
    const Bsp bsp = [&] {
      try {
        return build_bsp(std::move(polygons), config);
      } catch (const std::length_error& error) {
        throw InputError(std::string("painter: ") + error.what());
      }
    }();
    const glm::dvec4 eye = map.perspective ? glm::dvec4(0, 0, 0, 1) : glm::dvec4(0, 0, 1, 0);
    walk_bsp(bsp, eye, BspOrder::far_to_near, [&](std::uint32_t index) {
      ++counters.nodes_visited;
      const std::span<const BspFragment> fragments = bsp.fragments_of(bsp.nodes[index]);
      for (std::size_t i = fragments.size(); i-- > 0;) {
        const BspFragment& fragment = fragments[i];
        if (!fill_.set(map, bsp.polygons[fragment.source])) continue;
        points_.clear();
        for (const BspCorner& corner : bsp.corners_of(fragment)) points_.push_back(corner.position);
        if (!fill_.narrow(map, points_)) continue;
        for (const BspCorner& corner : bsp.corners_of(fragment))
          if (corner.cut != no_cut) fill_.cut(map, bsp.nodes[corner.cut / 2].plane, corner.cut % 2 != 0);
        paint(items_[begin + fragment.source], frame, counters);
      }
    });
  }

  const Scene& scene_;
  const Key key_;
  const bool split_;
  const std::size_t most_fragments_;
  std::vector<Item> items_;
  std::vector<glm::dvec3> points_;
  PolygonFill fill_;
};

}  // namespace

std::unique_ptr<Renderer> make_painter(const IndexedScene& scene, ParameterReader& parameters) {
  std::string key = "farthest";
  bool split = false;
  int most_fragments = 20'000'000;
  parameters.read("key", key);
  parameters.read("split", split);
  parameters.read("most_fragments", most_fragments, 1, 1'000'000'000);
  parameters.finish();
  const std::array<std::pair<std::string_view, Key>, 3> keys{
      {{"farthest", Key::farthest}, {"centroid", Key::centroid}, {"nearest", Key::nearest}}};
  const auto found = std::find_if(keys.begin(), keys.end(), [&](const auto& k) { return k.first == key; });
  if (found == keys.end()) throw InputError("key: '" + key + "' is not farthest, centroid or nearest");
  return std::make_unique<Painter>(scene.scene, found->second, split, static_cast<std::size_t>(most_fragments));
}

}  // namespace sightline
