// Objects on the move: smooth, rigid, the same for one seed, and at home in the first frame.
#include "sightline/scene/generate/motion.hpp"

#include <gtest/gtest.h>

#include "sightline/scene/generate/generate.hpp"

namespace sightline {
namespace {

TEST(Motion, AShareOfTheObjectsMovesSmoothlyAndKeepsItsShape) {
  Scene scene = generate_scene("city", {.objects = 400, .triangles = 0, .seed = 3});
  const Motion motion(scene, 0.25, 7);
  const double count = static_cast<double>(scene.objects().size());
  EXPECT_GT(static_cast<double>(motion.count()), 0.15 * count);
  EXPECT_LT(static_cast<double>(motion.count()), 0.35 * count);
  const double size = glm::length(glm::dvec3(scene.bounds().extent()));
  std::vector<Scene::Move> before = motion.at(0);
  for (const Scene::Move& move : before) EXPECT_EQ(move.transform, scene.objects()[move.object].transform);
  double farthest = 0;
  for (std::size_t frame = 1; frame < 300; ++frame) {
    const std::vector<Scene::Move> now = motion.at(frame);
    ASSERT_EQ(now.size(), before.size());
    for (std::size_t i = 0; i < now.size(); ++i) {
      ASSERT_EQ(now[i].object, before[i].object);
      const Object& home = scene.objects()[now[i].object];
      const Aabb& box = scene.mesh_of(now[i].object).bounds;
      const auto place = [&](const Affine& transform) { return glm::dvec3(transform_point(transform, box.centre())); };
      // A twentieth of the size across; a round takes at least 60 frames.
      EXPECT_LT(glm::length(place(now[i].transform) - place(before[i].transform)), 0.006 * size);
      EXPECT_LT(glm::length(place(now[i].transform) - place(home.transform)), 0.06 * size);
      EXPECT_NEAR(determinant(now[i].transform), determinant(home.transform),
                  1e-5 * std::abs(determinant(home.transform)));
      farthest = std::max(farthest, glm::length(place(now[i].transform) - place(home.transform)));
    }
    before = now;
  }
  EXPECT_GT(farthest, 0.02 * size);
}

TEST(Motion, SameSeedSameMotionAndNothingMovesWithoutAShare) {
  const Scene scene = generate_scene("city", {.objects = 100, .triangles = 0, .seed = 3});
  const auto at_9 = [&](double share, std::uint64_t seed) {
    std::vector<std::pair<ObjectId, Affine>> moves;
    for (const Scene::Move& move : Motion(scene, share, seed).at(9)) moves.emplace_back(move.object, move.transform);
    return moves;
  };
  EXPECT_EQ(at_9(0.5, 1), at_9(0.5, 1));
  EXPECT_NE(at_9(0.5, 1), at_9(0.5, 2));
  EXPECT_TRUE(at_9(0, 1).empty());
  EXPECT_EQ(at_9(1, 1).size(), scene.objects().size());
}

}  // namespace
}  // namespace sightline
