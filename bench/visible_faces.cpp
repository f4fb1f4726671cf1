// bench_visible_faces [faces] [cameras]: which of a million faces each of a hundred cameras of 2000 x 1000 pixels sees.
// Two scenes: a bumpy ball as a scanner leaves it (most faces below a pixel), and a generated city. Counts of three
// cameras are compared with the oracle's first; then the time of all cameras on all threads, without and with further
// points, and beside it the oracle's rays through pixel centres alone. Exits 1 if a count is wrong.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <vector>

#include "sightline/oracle/oracle.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/generate/shapes.hpp"
#include "sightline/surface/visible_faces.hpp"

namespace {

using namespace sightline;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

Scene bumpy_ball(std::size_t faces) {
  const int rings = static_cast<int>(std::sqrt(static_cast<double>(faces) / 4.0));
  Mesh mesh = make_ball(2 * rings, rings);
  Random random(1);
  for (glm::vec3& p : mesh.positions) {
    const double bump = std::sin(9.0 * p.x) * std::sin(7.0 * p.y + 1.0) * std::sin(8.0 * p.z);
    p *= static_cast<float>(1.0 + 0.08 * bump + 2e-4 * random.range(-1, 1));
  }
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(std::move(mesh)), identity_affine(), "scan");
  return builder.build();
}

std::vector<View> orbit(const Scene& scene, int count) {
  std::vector<View> views;
  const glm::dvec3 centre(scene.bounds().centre());
  const double size = glm::length(glm::dvec3(scene.bounds().extent()));
  for (int i = 0; i < count; ++i) {
    const double turn = 2.399963 * i, up = 0.15 + 0.8 * (i % 10) / 10.0;
    const glm::dvec3 way = glm::normalize(glm::dvec3(std::cos(turn), up, std::sin(turn)));
    View view = look_along(centre + (0.45 + 0.05 * (i % 7)) * size * way, -way);
    view.width = 2000;
    view.height = 1000;
    view.fov_y = 0.9;
    view.near = 1e-3 * size;
    view.far = 4 * size;
    views.push_back(view);
  }
  return views;
}

bool check(const Scene& scene, const Oracle& oracle, const View& view) {
  Frame frame;
  oracle.draw(view, frame);
  const std::vector<std::uint64_t> first = first_faces(scene);
  std::vector<std::uint32_t> truth(first.back(), 0);
  for (std::size_t i = 0; i < frame.object.size(); ++i)
    if (frame.object[i] != no_object) ++truth[first[frame.object[i]] + frame.triangle[i]];
  const CalibratedCamera camera = calibrated(view);
  std::size_t differ = 0, all = 0;
  visible_faces(scene, {&camera, 1}, {0}, [&](std::size_t, const CameraFaces& faces) {
    for (std::size_t f = 0; f < truth.size(); ++f) {
      differ += static_cast<std::size_t>(std::abs(static_cast<long>(truth[f]) - static_cast<long>(faces.samples[f])));
      all += truth[f];
    }
  });
  std::printf("  checked: %zu of %zu pixels go to another face than the oracle's (edges, coplanar faces)\n", differ / 2,
              all);
  return differ * 100 <= all;
}

}  // namespace

int main(int count, char** arguments) {
  const auto faces = static_cast<std::size_t>(count > 1 ? std::atoll(arguments[1]) : 1000000);
  const int cameras_wanted = count > 2 ? std::atoi(arguments[2]) : 100;
  for (const char* kind : {"scan", "city"}) {
    GenerateConfig config;
    config.objects = 3000;
    config.triangles = faces;
    const Scene scene = kind[0] == 's' ? bumpy_ball(faces) : generate_scene(kind, config);
    const std::vector<View> views = orbit(scene, cameras_wanted);
    std::printf("%s: %llu faces, %zu cameras of 2000 x 1000, %d threads\n", kind,
                static_cast<unsigned long long>(scene.triangle_count()), views.size(), thread_count());
    const Oracle oracle(scene);
    for (std::size_t i = 0; i < 3 && i < views.size(); ++i)
      if (!check(scene, oracle, views[i])) {
        std::fprintf(stderr, "bench_visible_faces: wrong counts\n");
        return 1;
      }
    std::vector<CalibratedCamera> cameras;
    for (const View& view : views) cameras.push_back(calibrated(view));
    for (const int points : {0, 1, 4}) {
      std::mutex mutex;
      std::uint64_t seen = 0, sampled = 0;
      const double start = now();
      visible_faces(scene, cameras, {points}, [&](std::size_t, const CameraFaces& result) {
        std::uint64_t s = 0, c = 0;
        for (std::size_t f = 0; f < result.seen.size(); ++f) {
          s += result.seen[f];
          c += result.samples[f] > 0 ? 1 : 0;
        }
        const std::lock_guard lock(mutex);
        seen += s;
        sampled += c;
      });
      const double seconds = now() - start;
      std::printf(
          "  %d further points: %7.2f s, %7.1f ms per camera; faces seen per camera %llu, by pixel centres %llu\n",
          points, seconds, 1e3 * seconds / static_cast<double>(views.size()),
          static_cast<unsigned long long>(seen / views.size()),
          static_cast<unsigned long long>(sampled / views.size()));
    }
    const double start = now();
    Frame frame;
    const std::size_t some = std::min<std::size_t>(views.size(), 10);
    for (std::size_t i = 0; i < some; ++i) oracle.draw(views[i], frame);
    std::printf("  the oracle's rays through pixel centres alone: %7.1f ms per camera (%zu cameras)\n",
                1e3 * (now() - start) / static_cast<double>(some), some);
  }
  return 0;
}
