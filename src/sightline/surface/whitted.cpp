#include "sightline/surface/whitted.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "sightline/index/bvh8.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/scene_soup.hpp"

namespace sightline {
namespace {

constexpr double far_away = 1e16;

/// origin + t * direction for t in [t_min, t_max].
struct LightRay {
  glm::dvec3 origin{0.0}, direction{0.0};
  double t_min = 0.0, t_max = 0.0;
};

struct Surface {
  double t = 0.0;
  ObjectId object = no_object;
  std::uint32_t triangle = 0;
  std::uint32_t place = 0;  // in the soup
};

/// Muted hues, apart by the golden ratio.
glm::vec3 colour_of(ObjectId id) {
  const double hue = 6.0 * std::fmod(static_cast<double>(id) * 0.6180339887498949, 1.0);
  const auto channel = [&](double shift) {
    const double k = std::fmod(shift + hue, 6.0);
    return static_cast<float>(0.9 * (1.0 - 0.45 * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0)));
  };
  return {channel(5.0), channel(3.0), channel(1.0)};
}

std::uint32_t pack(const glm::vec3& colour) {
  std::uint32_t result = 0xFF000000u;
  for (int i = 0; i < 3; ++i) {
    // Linear light to a display (gamma 2.2).
    const float value = std::pow(std::clamp(colour[i], 0.0f, 1.0f), 1.0f / 2.2f);
    result |= static_cast<std::uint32_t>(std::lround(255.0f * value)) << (8 * i);
  }
  return result;
}

class Whitted final : public Renderer {
 public:
  Whitted(const Scene& scene, const WhittedConfig& config) : scene_(scene), config_(config) {
    if (config_.lights.empty()) config_.lights.push_back({{0.4, 1.0, 0.3}, true, glm::vec3(1.0f)});
    // Far enough that a ray leaves the surface it starts at (hits are within 2^-20 of the extent, and rays are floats),
    // near enough that nothing fits between.
    offset_ = 0x1p-18 * std::max(1e-3, static_cast<double>(reach(scene.bounds())));
  }

  void draw(const View& view, const VisibleSet& visible, Frame& frame, Counters& counters) override {
    frame.clear(view.width, view.height);
    frame.colour.assign(frame.object.size(), pack(config_.sky));
    prepare_tree(visible);
    std::atomic<std::uint64_t> traced{0};
    parallel_blocks(static_cast<std::size_t>(view.height), 4, [&](std::size_t begin, std::size_t end) {
      std::uint64_t count = 0;
      for (std::size_t y = begin; y < end; ++y)
        for (int x = 0; x < view.width; ++x) draw_pixel(view, x, static_cast<int>(y), frame, count);
      traced.fetch_add(count, std::memory_order_relaxed);
    });
    counters.triangles_in += scene_.triangle_count();
    counters.pixels_tested += frame.object.size();
    counters.queries += traced.load();
    for (const ObjectId id : frame.object) counters.pixels_written += id != no_object ? 1 : 0;
  }

 private:
  /// The tree holds the visible objects alone, and is kept as long as those are the same.
  void prepare_tree(const VisibleSet& visible) {
    std::vector<ObjectId> objects = visible.sorted();
    if (built_ && objects == objects_) return;
    objects_ = std::move(objects);
    soup_ = soup_of(scene_, objects_);
    tree_ = build_bvh8(soup_);
    built_ = true;
  }

  bool nearest(const LightRay& ray, Surface& surface) const {
    const RayHit hit = trace_nearest(tree_, {glm::vec3(ray.origin), static_cast<float>(ray.t_min),
                                             glm::vec3(ray.direction), static_cast<float>(ray.t_max)});
    if (!hit.found()) return false;
    const TriangleSoup::Ids ids = soup_.ids(hit.triangle);
    surface = {static_cast<double>(hit.t), ids.object, ids.triangle, hit.triangle};
    return true;
  }

  void draw_pixel(const View& view, int x, int y, Frame& frame, std::uint64_t& count) const {
    const PixelRay pixel = pixel_ray(view, x + 0.5, y + 0.5);
    const LightRay ray{pixel.origin, pixel.direction, pixel.t_near, std::min(pixel.t_far, far_away)};
    Surface hit;
    ++count;
    if (!nearest(ray, hit)) return;
    const std::size_t at = frame.index(x, y);
    frame.depth[at] = static_cast<float>(hit.t);
    frame.object[at] = hit.object;
    frame.triangle[at] = hit.triangle;
    frame.colour[at] = pack(shade(ray, hit, 0, count));
  }

  [[nodiscard]] glm::vec3 trace(const LightRay& ray, int depth, std::uint64_t& count) const {
    Surface hit;
    ++count;
    if (!nearest(ray, hit)) return config_.sky;
    return shade(ray, hit, depth, count);
  }

  [[nodiscard]] WhittedMaterial material_of(ObjectId id) const {
    if (id < config_.materials.size()) return config_.materials[id];
    WhittedMaterial material;
    material.colour = colour_of(id);
    if (scene_.objects()[id].opaque) {
      material.reflect = static_cast<float>(config_.reflect);
    } else {
      material.colour = {0.75f, 0.85f, 0.85f};
      material.transmit = 0.75f;
      material.index = static_cast<float>(config_.index);
    }
    return material;
  }

  /// The share of a light that arrives: each transparent surface on the way lets its part through.
  [[nodiscard]] float light_share(LightRay ray, std::uint64_t& count) const {
    float share = 1.0f;
    for (int i = 0; i < 64 && share > 1.0f / 512.0f; ++i) {
      Surface hit;
      ++count;
      if (!nearest(ray, hit)) return share;
      share *= material_of(hit.object).transmit;
      ray.t_min = std::nextafter(hit.t, far_away) + offset_;
      if (ray.t_min > ray.t_max) return share;
    }
    return share > 1.0f / 512.0f ? share : 0.0f;
  }

  [[nodiscard]] glm::vec3 own_colour(const WhittedMaterial& material, const glm::dvec3& point, const glm::dvec3& normal,
                                     const glm::dvec3& towards_eye, std::uint64_t& count) const {
    glm::vec3 sum = material.ambient * material.colour;
    for (const WhittedLight& light : config_.lights) {
      const glm::dvec3 way = light.distant ? light.position : light.position - point;
      const double distance = glm::length(way);
      if (!(distance > 0.0)) continue;
      const glm::dvec3 towards_light = way / distance;
      const double lit = glm::dot(normal, towards_light);
      if (lit <= 0.0) continue;
      const LightRay ray{point + offset_ * normal, towards_light, 0.0, light.distant ? far_away : distance};
      const float share = config_.shadows ? light_share(ray, count) : 1.0f;
      const glm::dvec3 mirrored = 2.0 * lit * normal - towards_light;
      const double gleam = std::pow(std::max(0.0, glm::dot(mirrored, towards_eye)), material.shininess);
      sum += share * light.colour *
             (material.diffuse * static_cast<float>(lit) * material.colour +
              material.highlight * static_cast<float>(gleam));
    }
    return sum;
  }

  [[nodiscard]] glm::vec3 shade(const LightRay& ray, const Surface& hit, int depth, std::uint64_t& count) const {
    const WhittedMaterial material = material_of(hit.object);
    const glm::vec3* corner = soup_.triangle(hit.place);
    const glm::dvec3 c[3] = {glm::dvec3(corner[0]), glm::dvec3(corner[1]), glm::dvec3(corner[2])};
    const glm::dvec3 outward = glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0]));
    const glm::dvec3 direction = glm::normalize(ray.direction);
    const bool entering = glm::dot(outward, direction) < 0.0;
    const glm::dvec3 normal = entering ? outward : -outward;
    const glm::dvec3 point = ray.origin + hit.t * ray.direction;
    float reflect = material.reflect, transmit = material.transmit;
    glm::dvec3 onward = direction;
    if (transmit > 0.0f && material.index != 1.0f) {
      const double eta = entering ? 1.0 / static_cast<double>(material.index) : static_cast<double>(material.index);
      onward = glm::refract(direction, normal, eta);
      if (onward == glm::dvec3(0.0)) {  // total reflection
        reflect = std::min(1.0f, reflect + transmit);
        transmit = 0.0f;
      }
    }
    glm::vec3 colour(0.0f);
    const float own = std::max(0.0f, 1.0f - reflect - transmit);
    if (own > 0.0f) colour += own * own_colour(material, point, normal, -direction, count);
    if (reflect > 0.0f) {
      const LightRay mirrored{point + offset_ * normal, glm::reflect(direction, normal), 0.0, far_away};
      colour += reflect * (depth < config_.depth ? trace(mirrored, depth + 1, count) : config_.sky);
    }
    if (transmit > 0.0f) {
      const LightRay behind{point - offset_ * normal, onward, 0.0, far_away};
      colour += transmit * (depth < config_.depth ? trace(behind, depth + 1, count) : config_.sky);
    }
    return colour;
  }

  const Scene& scene_;
  WhittedConfig config_;
  double offset_ = 0.0;
  std::vector<ObjectId> objects_;
  TriangleSoup soup_;
  Bvh8 tree_;
  bool built_ = false;
};

}  // namespace

std::unique_ptr<Renderer> make_whitted(const Scene& scene, const WhittedConfig& config) {
  return std::make_unique<Whitted>(scene, config);
}

std::unique_ptr<Renderer> make_whitted_row(const IndexedScene& scene, ParameterReader& parameters) {
  WhittedConfig config;
  parameters.read("depth", config.depth, 0, 32);
  parameters.read("shadows", config.shadows);
  parameters.read("reflect", config.reflect, 0.0, 1.0);
  parameters.read("index", config.index, 1.0, 3.0);
  parameters.finish();
  return make_whitted(scene.scene, config);
}

}  // namespace sightline
