// bench_load [triangles]: how long a GLB takes to load, beside the plain read of its bytes and one pass over them.
// Scenes: one large closed mesh; a thousand meshes, each with an object of its own; a city of shared meshes with many
// objects. Each is written by save_glb and must load as it was before it is timed. Wall time, all threads and one,
// medians, one run.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <vector>

#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/load/file_bytes.hpp"
#include "sightline/scene/load/load.hpp"
#include "sightline/scene/save/glb.hpp"

namespace {

using namespace sightline;

/// A closed bumpy ring of `around` x `across` squares.
Mesh ring(std::uint32_t around, std::uint32_t across, float bumps) {
  Mesh mesh;
  mesh.name = "ring";
  constexpr float turn = 6.2831853f;
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const float u = turn * static_cast<float>(i) / static_cast<float>(around);
      const float v = turn * static_cast<float>(j) / static_cast<float>(across);
      const float thick = 1.0f + 0.1f * std::sin(bumps * u) * std::sin(bumps * v);
      mesh.positions.emplace_back((3.0f + thick * std::cos(v)) * std::cos(u), thick * std::sin(v),
                                  (3.0f + thick * std::cos(v)) * std::sin(u));
    }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return i % around * across + j % across; };
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  return mesh;
}

Scene rings(std::uint32_t count, double triangles_each) {
  SceneBuilder builder;
  const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(triangles_each / 2.0)));
  for (std::uint32_t i = 0; i < count; ++i)
    builder.add_object(builder.add_mesh(ring(side, side, 3.0f + static_cast<float>(i % 7))),
                       {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {10.0f * static_cast<float>(i), 0, 0}}, "ring");
  return builder.build();
}

bool same(const Scene& a, const Scene& b) {
  if (a.objects().size() != b.objects().size() || a.triangle_count() != b.triangle_count()) return false;
  for (ObjectId id = 0; id < a.objects().size(); ++id) {
    const Mesh &x = a.mesh_of(id), &y = b.mesh_of(id);
    if (a.name(id) != b.name(id) || x.positions != y.positions || x.triangles != y.triangles || x.closed != y.closed ||
        !(a.objects()[id].bounds == b.objects()[id].bounds))
      return false;
  }
  return true;
}

double milliseconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

bool measure(const char* name, const Scene& scene, const std::filesystem::path& file) {
  save_glb(scene, file);
  if (!same(scene, load_scene(file).scene)) {
    std::fprintf(stderr, "bench_load: %s does not load as it was saved\n", name);
    return false;
  }
  std::vector<double> read, one, all;
  volatile std::uint64_t sink = 0;
  for (int round = 0; round < 9; ++round) {
    read.push_back(milliseconds([&] {
      const Bytes bytes = read_file(file);
      std::uint64_t sum = 0, word = 0;
      for (std::size_t i = 0; i + 8 <= bytes.size(); i += 8) {
        std::memcpy(&word, bytes.data() + i, 8);
        sum += word;
      }
      sink = sum;
    }));
    all.push_back(milliseconds([&] { sink = load_scene(file).scene.triangle_count(); }));
    const ThreadLimit limit(1);
    one.push_back(milliseconds([&] { sink = load_scene(file).scene.triangle_count(); }));
  }
  std::size_t unique = 0;
  for (const Mesh& mesh : scene.meshes()) unique += mesh.triangles.size();
  std::printf(
      "%-14s %8zu objects %9llu triangles (%8zu of their own) %7.1f MB: read %6.1f ms, load %7.1f ms (one thread "
      "%7.1f ms), %5.1fx reading\n",
      name, scene.objects().size(), static_cast<unsigned long long>(scene.triangle_count()), unique,
      1e-6 * static_cast<double>(std::filesystem::file_size(file)), median(read), median(all), median(one),
      median(all) / median(read));
  return true;
}

}  // namespace

int main(int count, char** arguments) {
  const double asked = count > 1 ? std::atof(arguments[1]) : 0.0;  // 0 for options that other benchmarks take
  const double triangles = asked > 0.0 ? asked : 1e6;
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "sightline_bench_load.glb";
  GenerateConfig city;
  city.objects = static_cast<std::uint32_t>(std::max(100.0, triangles / 50.0));
  const bool good = measure("one mesh", rings(1, triangles), file) &&
                    measure("many meshes", rings(1000, triangles / 1000.0), file) &&
                    measure("city", generate_scene("city", city), file);
  std::filesystem::remove(file);
  return good ? 0 : 1;
}
