// A program of somebody else: culls a generated scene with the core library, and with the truth where it is there.
#include <cstdio>
#include <sightline/registry.hpp>
#include <sightline/scene/generate/generate.hpp>
#ifdef CONSUMER_HAS_ORACLE
#include <sightline/oracle/oracle.hpp>
#endif

int main() {
  const sightline::Scene scene = sightline::generate_scene("city", {.objects = 300});
  const sightline::IndexedScene indexed = sightline::index_scene(scene);
  const auto culler = sightline::make_culler("frustum_hierarchical", indexed);
  const sightline::View view = sightline::look_along({0.0, 1.7, 0.0}, {1.0, 0.0, 0.3});
  sightline::VisibleSet visible;
  sightline::Counters counters;
  culler->cull(view, sightline::VisibleSet::all(scene.objects().size()), visible, counters);
  std::printf("%zu of %zu objects may be seen\n", visible.count(), visible.universe());
  if (visible.count() == 0 || visible.is_all()) return 1;
#ifdef CONSUMER_HAS_ORACLE
  if (!sightline::judge(sightline::Oracle(scene).look(view), visible).missed.empty()) return 2;
#endif
  return 0;
}
