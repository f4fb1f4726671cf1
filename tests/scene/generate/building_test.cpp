// The cells and portals of a generated building, checked against rays: nobody sees through a wall without a portal.
#include <gtest/gtest.h>

#include <algorithm>

#include "sightline/oracle/oracle.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/generate/random.hpp"

namespace sightline {
namespace {

// The first cell that holds the point, which is how the generator defines the cell of a point.
std::uint32_t cell_of(const Scene& scene, const glm::vec3& point) {
  for (std::uint32_t i = 0; i < scene.cells().size(); ++i)
    if (scene.cells()[i].bounds.contains(point)) return i;
  return 0xFFFFFFFFu;
}

Aabb bounds_of(const Portal& portal) {
  Aabb box;
  for (const glm::vec3& p : portal.polygon) box.extend(p);
  return box;
}

double volume(const Aabb& box) {
  const glm::dvec3 e(box.extent());
  return e.x * e.y * e.z;
}

class Building : public testing::TestWithParam<std::uint32_t> {
 protected:
  const Scene scene = generate_scene("building", {GetParam(), 0, 7});
  const std::uint32_t outside = static_cast<std::uint32_t>(scene.cells().size()) - 1;
};

TEST_P(Building, CellsTileTheInside) {
  ASSERT_GE(scene.cells().size(), 4u);
  EXPECT_EQ(scene.cells()[outside].name, "outside");
  Aabb inside;
  double sum = 0;
  for (std::uint32_t i = 0; i < outside; ++i) {
    inside.extend(scene.cells()[i].bounds);
    sum += volume(scene.cells()[i].bounds);
  }
  EXPECT_NEAR(sum, volume(inside), 1e-3);
  Random random(1);
  for (int k = 0; k < 500; ++k) {
    glm::vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<float>(random.range(inside.lo[axis], inside.hi[axis]));
    EXPECT_NE(cell_of(scene, p), 0xFFFFFFFFu);
  }
  EXPECT_TRUE(scene.cells()[outside].bounds.contains(scene.bounds()));
}

TEST_P(Building, ObjectsLieInTheirCells) {
  std::vector<int> cells_of(scene.objects().size(), 0);
  for (const Cell& cell : scene.cells()) {
    EXPECT_TRUE(std::is_sorted(cell.objects.begin(), cell.objects.end()));
    for (const ObjectId id : cell.objects) {
      ++cells_of[id];
      EXPECT_TRUE(cell.bounds.overlaps(scene.objects()[id].bounds)) << cell.name << " " << scene.name(id);
    }
  }
  for (ObjectId id = 0; id < cells_of.size(); ++id) EXPECT_GT(cells_of[id], 0) << scene.name(id) << " is in no cell";
}

TEST_P(Building, PortalsLieBetweenTheirCells) {
  EXPECT_GE(scene.portals().size(), scene.cells().size() / 2);
  std::vector<int> portals_of(scene.cells().size(), 0);
  for (const Portal& portal : scene.portals()) {
    ASSERT_NE(portal.cells[0], portal.cells[1]);
    const Aabb box = bounds_of(portal);
    EXPECT_EQ(portal.polygon.size(), 4u);
    EXPECT_GT(box.half_area(), 0.5f);
    for (const std::uint32_t cell : portal.cells) {
      ++portals_of[cell];
      EXPECT_TRUE(scene.cells()[cell].bounds.contains(box)) << scene.cells()[cell].name;
    }
    // On the face where both meet, not somewhere within one of them.
    if (portal.cells[0] == outside || portal.cells[1] == outside) continue;
    const Aabb &a = scene.cells()[portal.cells[0]].bounds, &b = scene.cells()[portal.cells[1]].bounds;
    const Aabb common{glm::max(a.lo, b.lo), glm::min(a.hi, b.hi)};
    const glm::vec3 e = common.extent();
    EXPECT_EQ(std::min({e.x, e.y, e.z}), 0.0f);
    EXPECT_TRUE(common.contains(box));
  }
  for (std::uint32_t i = 0; i < portals_of.size(); ++i) EXPECT_GT(portals_of[i], 0) << scene.cells()[i].name;
}

// Follows the way of light from eye to hit through the cells. Returns an empty text if every boundary is crossed in a
// portal and the cell at the end lists the object.
std::string check_way(const Scene& scene, const glm::dvec3& eye, const glm::dvec3& hit, ObjectId object) {
  const std::uint32_t outside = static_cast<std::uint32_t>(scene.cells().size()) - 1;
  std::uint32_t cell = cell_of(scene, glm::vec3(eye));
  const glm::dvec3 way = hit - eye;
  for (int steps = 0; steps < 100 && cell != outside; ++steps) {
    const Aabb& box = scene.cells()[cell].bounds;
    double leave = 2;  // where the way leaves the cell, as a share of it
    for (int axis = 0; axis < 3; ++axis)
      if (way[axis] != 0) leave = std::min(leave, ((way[axis] > 0 ? box.hi : box.lo)[axis] - eye[axis]) / way[axis]);
    if (leave >= 1 - 1e-6) break;
    const glm::dvec3 exit = eye + leave * way;
    std::uint32_t next = cell;
    for (const Portal& portal : scene.portals()) {
      if (portal.cells[0] != cell && portal.cells[1] != cell) continue;
      Aabb box_of_portal = bounds_of(portal);
      box_of_portal.lo -= 1e-4f;
      box_of_portal.hi += 1e-4f;
      if (box_of_portal.contains(glm::vec3(exit))) next = portal.cells[0] == cell ? portal.cells[1] : portal.cells[0];
    }
    if (next == cell) return "no portal out of " + scene.cells()[cell].name;
    cell = next;
  }
  const std::vector<ObjectId>& objects = scene.cells()[cell].objects;
  if (std::binary_search(objects.begin(), objects.end(), object)) return "";
  return std::string(scene.name(object)) + " is not listed in " + scene.cells()[cell].name;
}

TEST_P(Building, NobodySeesThroughWalls) {
  const Oracle oracle(scene);
  Random random(3);
  Frame frame;
  std::size_t far = 0;
  for (int k = 0; k < 60; ++k) {
    const Aabb& room = scene.cells()[random.below(outside)].bounds;
    glm::dvec3 eye;
    for (int axis = 0; axis < 3; ++axis) eye[axis] = random.range(room.lo[axis] + 0.3, room.hi[axis] - 0.3);
    View view = look_along(eye, random.direction() * glm::dvec3(1, 0.3, 1));
    view.width = view.height = 48;
    view.near = 1e-3;
    oracle.draw(view, frame);
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x) {
        const std::size_t pixel = frame.index(x, y);
        if (frame.object[pixel] == no_object) continue;
        const PixelRay ray = pixel_ray(view, x + 0.5, y + 0.5);
        const glm::dvec3 hit = ray.origin + ray.direction * static_cast<double>(frame.depth[pixel]);
        far += room.contains(glm::vec3(hit)) ? 0 : 1;
        ASSERT_EQ(check_way(scene, eye, hit, frame.object[pixel]), "");
      }
  }
  EXPECT_GT(far, 100u) << "some must look through doors";
}

TEST_P(Building, PortalsAreOpen) {
  const Oracle oracle(scene);
  std::size_t open = 0;
  for (const Portal& portal : scene.portals()) {
    const Aabb box = bounds_of(portal);
    const glm::dvec3 e(box.extent());
    const glm::dvec3 across = e.x <= 0 ? glm::dvec3(1, 0, 0) : e.y <= 0 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    View view = look_along(glm::dvec3(box.centre()) - 0.2 * across, across);
    view.width = view.height = 1;
    view.near = 1e-3;
    view.far = 0.4;
    const VisibleSet seen = oracle.look(view).seen;
    for (const ObjectId id : seen.order())  // furniture and doors may stand in the way, the building itself must not
      for (const std::string_view structure : {"wall", "corridor wall", "partition", "facade", "slab", "ground"})
        EXPECT_NE(scene.name(id).substr(0, structure.size()), structure) << scene.name(id);
    open += seen.count() == 0 ? 1 : 0;
  }
  EXPECT_GT(3 * open, scene.portals().size()) << "not all may be shut";
}

INSTANTIATE_TEST_SUITE_P(Sizes, Building, testing::Values(48u, 100u, 700u, 4000u));

TEST(BuildingFragment, HasNoCells) {
  const Scene scene = generate_scene("building", {47, 0, 1});
  EXPECT_TRUE(scene.cells().empty());
  EXPECT_TRUE(scene.portals().empty());
}

}  // namespace
}  // namespace sightline
