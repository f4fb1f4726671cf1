// sightline generate: a generated scene as a file.
#include <fmt/format.h>

#include "json_output.hpp"
#include "scene_argument.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/save/glb.hpp"
#include "verbs.hpp"

namespace sightline::cli {

int run_generate(const GenerateOptions& options) {
  JsonOutput output(options.common);
  GenerateConfig config;
  config.objects = options.objects;
  config.triangles = options.triangles;
  config.seed = options.common.seed;
  Progress progress("generate", 2, options.common.quiet);
  const Scene scene = as_usage([&] { return generate_scene(options.kind, config); });
  progress.show(1);
  save_glb(scene, options.output);
  progress.show(2);
  if (options.common.prints())
    fmt::print("{}: {} objects, {} triangles, {} unique meshes\n", options.output, scene.objects().size(),
               scene.triangle_count(), scene.meshes().size());
  output.write({{"schema", "sightline.generate/1"},
                {"output", options.output},
                {"kind", options.kind},
                {"seed", config.seed},
                {"objects", scene.objects().size()},
                {"triangles", scene.triangle_count()},
                {"unique_meshes", scene.meshes().size()}});
  return exit_ok;
}

}  // namespace sightline::cli
