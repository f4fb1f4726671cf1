// The README's example: which objects of a generated city are seen from a point, culled and checked against the truth.
#include <cstdio>

#include "sightline/oracle/oracle.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/camera_path.hpp"
#include "sightline/scene/generate/generate.hpp"

int main() {
  using namespace sightline;
  // [readme]
  const Scene scene = generate_scene("city", {.objects = 5000});   // or load_scene("building.glb").scene
  const IndexedScene indexed = index_scene(scene);                 // adds the bounding volume hierarchy
  const View view = generate_path(scene, {.frames = 2}).views[0];  // or look_along(eye, direction)
  const auto culler = make_culler("occlusion_masked", indexed);    // any row of the table below
  VisibleSet visible;
  Counters counters;
  culler->cull(view, VisibleSet::all(scene.objects().size()), visible, counters);
  const Verdict verdict = judge(Oracle(scene).look(view), visible);  // one ray through every pixel centre
  std::printf("%zu of %zu objects may be seen, %zu are, %zu missed\n", visible.count(), visible.universe(),
              verdict.truth, verdict.missed.size());
  // [/readme]
  return verdict.missed.empty() ? 0 : 1;
}
