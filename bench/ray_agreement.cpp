// bench_ray_agreement [--structures=A,B,...] [RAYS [SCENE.glb ...]]: every tracing structure, or some, on the same
// random rays, hit by hit against the first one, and that one against Embree's robust mode. Default: 100,000 rays on
// three scenes of ../shared/scenes. Exits 1 at a difference between our structures, or a hit that Embree does not share
// and that neither a tie nor a grazed border explains.
#include <atomic>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "embree_rays.hpp"
#include "sightline/index/tracer.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/load.hpp"
#include "sightline/scene/scene_soup.hpp"

namespace {

using namespace sightline;

/// Anywhere in a box a little larger than the scene, in any direction; every fourth along an axis, every fourth to a
/// vertex. The same for any number of threads.
Ray ray_number(std::uint64_t number, const TriangleSoup& soup, const Aabb& box) {
  Random random(number, 17);
  const auto within = [&](int axis) {
    return static_cast<float>(random.range(static_cast<double>(box.lo[axis]), static_cast<double>(box.hi[axis])));
  };
  Ray ray{
      {within(0), within(1), within(2)}, 0.0f, glm::vec3(random.direction()), std::numeric_limits<float>::infinity()};
  if (number % 4 == 1) {
    ray.direction = glm::vec3(0.0f);
    ray.direction[static_cast<int>(random.below(3))] = random.chance(0.5) ? 1.0f : -1.0f;
  }
  if (number % 4 == 2)
    ray.direction = soup.corners[random.below(static_cast<std::uint32_t>(soup.corners.size()))] - ray.origin;
  return ray;
}

struct Counts {
  std::atomic<std::uint64_t> hits{0}, ties{0}, grazing{0}, other{0};
};

/// How far our hit and Embree's are apart along the ray, in units of the scene's extent.
bool is_tie(const RayHit& a, const RayHit& b, const Ray& ray, float extent) {
  if (!a.found() || !b.found()) return false;
  const double apart =
      std::abs(static_cast<double>(a.t) - static_cast<double>(b.t)) * glm::length(glm::dvec3(ray.direction));
  return apart <= 1e-5 * static_cast<double>(extent);
}

/// Distance of the ray's line to the segment.
double distance_to_edge(const Ray& ray, const glm::vec3& a, const glm::vec3& b) {
  const glm::dvec3 d = glm::normalize(glm::dvec3(ray.direction));
  // Across the line the ray is a point.
  const auto across = [&](const glm::vec3& p) {
    const glm::dvec3 v = glm::dvec3(p) - glm::dvec3(ray.origin);
    return v - glm::dot(v, d) * d;
  };
  const glm::dvec3 p = across(a), e = across(b) - p;
  const double length2 = glm::dot(e, e);
  const double s = length2 > 0.0 ? std::clamp(-glm::dot(p, e) / length2, 0.0, 1.0) : 0.0;
  return glm::length(p + s * e);
}

/// The nearer of two different hits is at the border of its triangle, up to rounding: one met it, the other passed by.
bool is_grazing(const RayHit& a, const RayHit& b, const Ray& ray, const TriangleSoup& soup, float extent) {
  const RayHit& nearer = !b.found() || (a.found() && a.t < b.t) ? a : b;
  const glm::vec3* c = soup.triangle(nearer.triangle);
  const double distance = std::min(
      {distance_to_edge(ray, c[0], c[1]), distance_to_edge(ray, c[1], c[2]), distance_to_edge(ray, c[2], c[0])});
  return distance <= 0x1p-20 * static_cast<double>(extent);
}

bool agree(const std::string& name, const TriangleSoup& soup, std::uint64_t rays,
           const std::vector<const TracerKind*>& kinds) {
  Aabb box = bounds_of(soup);
  const float extent = std::max({box.extent().x, box.extent().y, box.extent().z});
  box.lo -= 0.05f * extent;
  box.hi += 0.05f * extent;
  std::printf("%s: %zu triangles, %llu rays\n", name.c_str(), soup.size(), static_cast<unsigned long long>(rays));
  constexpr std::size_t block = 4096;
  std::vector<RayHit> first(rays);
  bool good = true;
  for (const TracerKind* kind : kinds) {
    if (kind->name == "brute" && rays * soup.size() > 20'000'000'000) continue;
    const std::unique_ptr<Tracer> tracer = kind->make(soup);
    const bool is_first = kind == kinds.front();
    Counts counts;
    parallel_blocks(rays, block, [&](std::size_t begin, std::size_t end) {
      TraceCounters work;
      std::uint64_t hits = 0, other = 0;
      for (std::size_t i = begin; i < end; ++i) {
        const RayHit hit = tracer->nearest(ray_number(i, soup, box), work);
        hits += hit.found() ? 1 : 0;
        if (is_first)
          first[i] = hit;
        else
          other += hit == first[i] ? 0 : 1;
      }
      counts.hits += hits;
      counts.other += other;
    });
    std::printf("  %-15s %10llu hits, %llu differ\n", kind->name.data(),
                static_cast<unsigned long long>(counts.hits.load()),
                static_cast<unsigned long long>(counts.other.load()));
    std::fflush(stdout);
    good &= counts.other == 0;
  }
  EmbreeRays embree(soup, RTC_SCENE_FLAG_ROBUST);
  embree.build();
  Counts counts;
  parallel_blocks(rays, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Ray ray = ray_number(i, soup, box);
      const RayHit hit = embree.nearest(ray);
      counts.hits += hit.found() ? 1 : 0;
      if (hit.triangle == first[i].triangle) continue;
      if (is_tie(hit, first[i], ray, extent))
        ++counts.ties;
      else if (is_grazing(hit, first[i], ray, soup, extent))
        ++counts.grazing;
      else if (++counts.other <= 10)
        std::printf("    ray %zu: embree %u at %.9g, ours %u at %.9g\n", i, hit.triangle, static_cast<double>(hit.t),
                    first[i].triangle, static_cast<double>(first[i].t));
    }
  });
  std::printf(
      "  %-15s %10llu hits, %llu ties (same place up to 1e-5 of the extent), %llu grazing (a border within "
      "2^-20 of it), %llu differ\n",
      "embree robust", static_cast<unsigned long long>(counts.hits.load()),
      static_cast<unsigned long long>(counts.ties.load()), static_cast<unsigned long long>(counts.grazing.load()),
      static_cast<unsigned long long>(counts.other.load()));
  return good && counts.other == 0;
}

}  // namespace

int main(int count, char** arguments) {
  std::vector<std::string> words;
  std::vector<const TracerKind*> kinds;
  const std::string_view option = "--structures=";
  for (int i = 1; i < count; ++i) {
    const std::string_view word = arguments[i];
    if (word.starts_with(option)) {
      std::istringstream names{std::string(word.substr(option.size()))};
      for (std::string name; std::getline(names, name, ',');) {
        kinds.push_back(find_tracer(name));
        if (kinds.back() != nullptr) continue;
        std::fprintf(stderr, "bench_ray_agreement: no structure is called '%s'\n", name.c_str());
        return 2;
      }
    } else if (!word.starts_with('-')) {
      words.emplace_back(word);
    }
  }
  if (kinds.empty())
    for (const TracerKind& kind : tracer_kinds()) kinds.push_back(&kind);
  const std::uint64_t rays = words.empty() ? 100000 : std::stoull(words[0]);
  std::vector<std::string> files(words.begin() + (words.empty() ? 0 : 1), words.end());
  const std::string folder = std::string(SIGHTLINE_SOURCE_DIR) + "/../shared/scenes/";
  if (files.empty())
    files = {folder + "intel-castle/intel-castle.glb", folder + "medical-clinic/medical-clinic.glb",
             folder + "scan-meshes/koala.glb"};
  bool good = true;
  for (const std::string& file : files) {
    try {
      good &= agree(std::filesystem::path(file).filename().string(), soup_of(load_scene(file).scene), rays, kinds);
    } catch (const InputError& error) {
      std::fprintf(stderr, "bench_ray_agreement: skipped: %s\n", error.what());
    }
  }
  return good ? 0 : 1;
}
