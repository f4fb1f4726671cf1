// A program of somebody else: culls a generated scene with the core library, and with the truth where it is there.
#include <cstdio>
#include <sightline/registry.hpp>
#include <sightline/scene/generate/generate.hpp>
#ifdef CONSUMER_HAS_ORACLE
#include <sightline/oracle/oracle.hpp>
#endif
#ifdef CONSUMER_HAS_GL
#include <gl/registry.hpp>
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
#ifdef CONSUMER_HAS_GL
  try {
    sightline::gl::Context context;
    sightline::gl::MethodCuller chcpp(std::make_shared<sightline::gl::SceneDrawing>(context, scene), "gl_chcpp");
    sightline::VisibleSet drawn;
    chcpp.cull(view, sightline::VisibleSet::all(scene.objects().size()), drawn, counters);
    std::printf("%zu drawn by %s\n", drawn.count(), context.description().c_str());
    if (drawn.count() == 0 || drawn.count() > visible.count()) return 3;
  } catch (const sightline::gl::Unavailable& error) {
    std::printf("skipped: %s\n", error.what());
  }
#endif
  return 0;
}
