// Any text as a method: an error of one line, or a culler that runs on a small scene.
#include <cstdlib>
#include <string_view>

#include "sightline/registry.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/input_error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace sightline;
  static const Scene scene = generate_scene("soup", {.objects = 20});
  static const IndexedScene indexed = index_scene(scene);
  View view = look_along({0.0, 1.0, 0.0}, {1.0, 0.0, 0.3});
  view.width = 40;
  view.height = 30;
  try {
    const auto culler = make_culler(std::string_view(reinterpret_cast<const char*>(data), size), indexed);
    VisibleSet visible;
    Counters counters;
    culler->cull(view, VisibleSet::all(scene.objects().size()), visible, counters);
  } catch (const InputError& error) {
    if (error.reason().empty()) std::abort();
  }
  return 0;
}
