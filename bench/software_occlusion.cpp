// bench_software_occlusion [frames=24 [horizon|auto|order|approximate]]: the occlusion cullers beside each other on the
// real scenes, checked before anything is timed, contenders interleaved. (1) The horizon against the masked buffer on
// dover-city, one core. (2) Automatic occluders against all triangles. (3) Culling rate for each order
// (checklist 21.17). (4) What sampling and thresholds lose. Exits 1 if a conservative answer is wrong; real scenes that
// are missing are said to be.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include "sightline/oracle/oracle.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/auto_occluders.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/camera_path.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/load.hpp"

namespace {

using namespace sightline;

constexpr int rounds = 5;

double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

struct Contender {
  std::string method;
  std::unique_ptr<Culler> culler;
  std::size_t visible = 0, missed = 0, extra = 0;
  std::uint64_t lost = 0, occluder_triangles = 0, queries = 0, saved = 0;
  std::vector<double> times;
};

struct Task {
  Scene scene;
  std::vector<View> views;
  std::size_t frustum = 0, truth = 0;
  std::vector<Contender> contenders;
  bool wrong = false;

  Task(Scene made, int frames, const std::vector<std::string>& methods) : scene(std::move(made)) {
    PathConfig config;
    config.frames = frames;
    views = generate_path(scene, config).views;
    const IndexedScene indexed = index_scene(scene);
    run(indexed, methods);
  }

  void run(const IndexedScene& indexed, const std::vector<std::string>& methods) {
    const Oracle oracle(scene);
    const VisibleSet all = VisibleSet::all(scene.objects().size());
    const auto frustum_culler = make_culler("frustum_linear", indexed);
    for (const std::string& method : methods) {
      contenders.push_back({});
      contenders.back().method = method;
      contenders.back().culler = make_culler(method, indexed);
    }
    VisibleSet visible;
    for (const View& view : views) {  // correctness first
      const Truth seen = oracle.look(view);
      Counters unused;
      frustum_culler->cull(view, all, visible, unused);
      frustum += visible.count();
      truth += seen.seen.count();
      for (Contender& c : contenders) {
        Counters counters;
        c.culler->cull(view, all, visible, counters);
        const Verdict verdict = judge(seen, visible);
        c.visible += visible.count();
        c.missed += verdict.missed.size();
        c.lost += verdict.missed_samples;
        c.extra += verdict.extra;
        c.occluder_triangles += counters.occluder_triangles;
        c.queries += counters.queries;
        c.saved += counters.queries_saved;
        const Promise of_row = find_algorithm(parse_method(c.method).name, Family::culler).promise;
        if (!verdict.missed.empty() && c.culler->promise(of_row) != Promise::approximate) wrong = true;
      }
    }
    if (wrong) return;
    for (int round = 0; round < rounds; ++round)
      for (const View& view : views)
        for (Contender& c : contenders) {
          Counters counters;
          const double start = cpu_ms();
          c.culler->cull(view, all, visible, counters);
          c.times.push_back(cpu_ms() - start);
        }
  }

  [[nodiscard]] double found(const Contender& c) const { return static_cast<double>(frustum - c.visible); }

  /// x and `% of`: against the first contender.
  void print() const {
    const double frames = static_cast<double>(views.size());
    std::printf("%zu objects, %llu triangles, %zu frames of 1280x720; in the frustum %.0f, seen %.0f\n",
                scene.objects().size(), static_cast<unsigned long long>(scene.triangle_count()), views.size(),
                static_cast<double>(frustum) / frames, static_cast<double>(truth) / frames);
    std::printf("%-66s %9s %8s %8s %9s %10s %10s %9s %8s\n", "method", "visible", "% of 1st", "missed", "lost px",
                "occl. tri", "queries", "ms", "x 1st");
    for (const Contender& c : contenders)
      std::printf("%-66s %9.1f %8.2f %8zu %9llu %10.0f %10.0f %9.3f %8.2f\n", c.method.c_str(),
                  static_cast<double>(c.visible) / frames, 100 * found(c) / std::max(1.0, found(contenders[0])),
                  c.missed, static_cast<unsigned long long>(c.lost), static_cast<double>(c.occluder_triangles) / frames,
                  static_cast<double>(c.queries) / frames, median(c.times),
                  median(contenders[0].times) / std::max(1e-9, median(c.times)));
  }
};

Scene real(const std::string& name) {
  return load_scene(std::filesystem::path(SIGHTLINE_SOURCE_DIR) / ".." / "shared" / "scenes" / name / (name + ".glb"))
      .scene;
}

bool run(const char* title, Scene scene, int frames, const std::vector<std::string>& methods) {
  std::printf("\n%s\n", title);
  const Task task(std::move(scene), frames, methods);
  if (task.wrong) std::printf("A CONSERVATIVE METHOD MISSED SOMETHING; nothing is timed\n");
  task.print();
  return !task.wrong;
}

bool automatic(const std::string& name, int frames) {
  Scene scene = real(name);
  const AutoOccluders occluders = make_auto_occluders(scene);
  std::printf(
      "\nautomatic occluders of %s: %llu triangles (%llu of surfaces, %llu of boxes inside), %.2f %% of the scene\n",
      name.c_str(), static_cast<unsigned long long>(occluders.triangles),
      static_cast<unsigned long long>(occluders.surface_triangles),
      static_cast<unsigned long long>(occluders.solid_triangles),
      100.0 * static_cast<double>(occluders.triangles) / static_cast<double>(scene.triangle_count()));
  return run("the first draws all triangles of all objects", std::move(scene), frames,
             {"occlusion_masked:triangles=1000000000:min_size=0",
              "occlusion_masked:occluders=auto:triangles=1000000000:min_size=0", "occlusion_masked:occluders=auto",
              "occlusion_masked"});
}

}  // namespace

int main(int count, char** arguments) {
  const ThreadLimit limit(1);
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // what is known stays known if somebody stops it
  const std::string only = count > 2 ? arguments[2] : "";
  const auto wanted = [&](const char* part) { return only.empty() || only == part; };
  const int frames = count > 1 ? std::max(1, std::atoi(arguments[1])) : 24;
  bool good = true;
  const auto attempt = [&](auto&& task) {
    try {
      good = task() && good;
    } catch (const InputError& error) {
      std::printf("\nSKIPPED: %s\n", error.what());
    }
  };
  if (wanted("horizon"))
    attempt([&] {
      return run("the horizon on dover-city", real("dover-city"), frames,
                 {"occlusion_masked", "occlusion_horizon", "occlusion_horizon:columns=240",
                  "occlusion_horizon:columns=480", "occlusion_horizon:occluders=boxes"});
    });
  for (const char* name : {"intel-castle", "medical-clinic", "aws-hospital"})
    if (wanted("auto")) attempt([&] { return automatic(name, frames); });
  const auto city = [] { return generate_scene("city", {.objects = 5000, .triangles = 0, .seed = 1}); };
  if (wanted("order"))
    attempt([&] {
      return run("order of processing, generated city", city(), frames,
                 {"occlusion_hzb", "occlusion_hzb:order=random", "occlusion_hzb:order=worst", "occlusion_map",
                  "occlusion_map:map=off", "occlusion_map:order=random", "occlusion_map:order=worst",
                  "occlusion_virtual", "occlusion_virtual:order=random", "occlusion_virtual:order=worst"});
    });
  if (wanted("approximate"))
    attempt([&] {
      return run("approximate modes, generated city", city(), frames,
                 {"occlusion_hzb", "occlusion_hzb:pixels=4", "occlusion_hzb:pixels=25", "occlusion_hzb:pixels=100",
                  "occlusion_hom", "occlusion_hom:holes=16", "occlusion_hom:opacity=0.9", "occlusion_hom:opacity=0.7",
                  "occlusion_virtual:step=1", "occlusion_virtual:step=2", "occlusion_virtual:step=4",
                  "occlusion_virtual:step=8", "occlusion_virtual:step=16"});
    });
  return good ? 0 : 1;
}
