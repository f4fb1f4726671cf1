// A ball of glass, a mirroring one and blocks on tiles, drawn by whitted with a table of materials.
// still_life [scene.glb]: also writes the scene.
#include <cstdio>
#include <glm/gtc/quaternion.hpp>

#include "sightline/scene/generate/shapes.hpp"
#include "sightline/scene/save/glb.hpp"
#include "sightline/surface/whitted.hpp"

using namespace sightline;

namespace {

Affine placed(const glm::vec3& scale, const glm::vec3& at) {
  return {{scale.x, 0, 0}, {0, scale.y, 0}, {0, 0, scale.z}, at};
}

Scene still_life() {
  SceneBuilder builder;
  const MeshId ball = builder.add_mesh(make_ball(96, 48)), block = builder.add_mesh(make_box({-1, 0, -1}, {1, 1, 1}));
  builder.add_object(ball, placed(glm::vec3(1), {-1.1f, 1, 0.6f}), "glass ball", {}, false);
  builder.add_object(ball, placed(glm::vec3(1.2f), {1.4f, 1.2f, -1.2f}), "mirror ball");
  for (int x = -5; x < 5; ++x)
    for (int z = -5; z < 5; ++z)
      builder.add_object(block,
                         placed({0.5f, 0.1f, 0.5f}, {static_cast<float>(x) + 0.5f, (x + z) % 2 == 0 ? -0.1f : -0.101f,
                                                     static_cast<float>(z) + 0.5f}),
                         "tile");
  builder.add_object(block, placed({0.35f, 1.6f, 0.35f}, {-2.6f, 0, -2.0f}), "post");
  builder.add_object(block, placed({0.5f, 0.6f, 0.5f}, {0.3f, 0, -2.9f}), "block");
  builder.add_object(block, placed({0.3f, 0.35f, 0.3f}, {1.0f, 0, 1.4f}), "small block");
  return builder.build();
}

}  // namespace

int main(int count, char** arguments) {
  const Scene scene = still_life();
  if (count > 1) save_glb(scene, arguments[1]);
  WhittedConfig config;
  for (const Object& object : scene.objects()) {
    WhittedMaterial material;
    if (!object.opaque) material.transmit = 0.92f, material.index = 1.5f;
    config.materials.push_back(material);
  }
  config.materials[1].reflect = 0.85f;
  View view = look_along({0, 2, 6}, {0, -0.2, -1});
  view.width = 64;
  view.height = 48;
  Frame frame;
  Counters counters;
  make_whitted(scene, config)->draw(view, VisibleSet::all(scene.objects().size()), frame, counters);
  std::printf("%zu pixels, %llu rays\n", frame.colour.size(), static_cast<unsigned long long>(counters.queries));
  return counters.queries > frame.colour.size() ? 0 : 1;
}
