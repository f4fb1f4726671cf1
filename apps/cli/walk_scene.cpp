#include "walk_scene.hpp"

#include <chrono>

namespace sightline::cli {

WalkScene::WalkScene(Scene& scene, double moving, std::uint64_t seed, bool truth)
    : scene_(scene), motion_(scene, moving, seed), indexed_(index_scene(scene)) {
  if (truth) oracle_.emplace(scene);
}

double WalkScene::to_frame(std::size_t frame) {
  if (frame == frame_ || motion_.count() == 0) return 0.0;
  frame_ = frame;
  const auto start = std::chrono::steady_clock::now();
  scene_.move_objects(motion_.at(frame));
  refit(indexed_);
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
  if (oracle_) oracle_.emplace(scene_);
  return taken.count();
}

}  // namespace sightline::cli
