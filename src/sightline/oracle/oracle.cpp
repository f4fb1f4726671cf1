#include "sightline/oracle/oracle.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "sightline/parallel/parallel.hpp"

namespace sightline {
namespace {

constexpr int lanes = 16;
constexpr std::uint64_t most_triangles_copied = 4'000'000;
constexpr int tile = 16;  // pixels; one tile is one block of work

/// Up to 16 rays of neighbouring samples.
struct Packet {
  alignas(64) int valid[lanes];
  alignas(64) RTCRayHit16 rays;

  /// The object hit by a lane, or no_object.
  [[nodiscard]] ObjectId object(int lane) const {
    if (rays.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) return no_object;
    const unsigned instance = rays.hit.instID[0][lane];
    return instance != RTC_INVALID_GEOMETRY_ID ? instance : rays.hit.geomID[lane];
  }
};

/// The rays of a view in float, relative to its eye in world space; linear in the sample position.
struct RayBasis {
  glm::dvec3 origin, origin_dx, origin_dy, direction, direction_dx, direction_dy;
  float t_near, t_far;

  explicit RayBasis(const View& view) {
    const PixelRay o = pixel_ray(view, 0, 0), x = pixel_ray(view, view.width, 0), y = pixel_ray(view, 0, view.height);
    origin = o.origin;
    direction = o.direction;
    origin_dx = (x.origin - o.origin) / static_cast<double>(view.width);
    origin_dy = (y.origin - o.origin) / static_cast<double>(view.height);
    direction_dx = (x.direction - o.direction) / static_cast<double>(view.width);
    direction_dy = (y.direction - o.direction) / static_cast<double>(view.height);
    t_near = static_cast<float>(o.t_near);
    t_far = static_cast<float>(std::min(o.t_far, static_cast<double>(std::numeric_limits<float>::max())));
  }

  void set(Packet& packet, int lane, double px, double py) const {
    const glm::vec3 o(origin + px * origin_dx + py * origin_dy);
    const glm::vec3 d(direction + px * direction_dx + py * direction_dy);
    RTCRay16& ray = packet.rays.ray;
    ray.org_x[lane] = o.x;
    ray.org_y[lane] = o.y;
    ray.org_z[lane] = o.z;
    ray.dir_x[lane] = d.x;
    ray.dir_y[lane] = d.y;
    ray.dir_z[lane] = d.z;
    ray.tnear[lane] = t_near;
    ray.tfar[lane] = t_far;
    ray.time[lane] = 0.0f;
    ray.mask[lane] = 0xFFFFFFFFu;
    ray.id[lane] = static_cast<unsigned>(lane);
    ray.flags[lane] = 0;
    packet.valid[lane] = -1;
    packet.rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    packet.rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
};

}  // namespace

struct Oracle::Rays {
  /// `only` may be null: all objects.
  Rays(const Scene& s, const VisibleSet* only) : scene(s) {
    device = rtcNewDevice("threads=0");
    assert(device != nullptr);
    top = new_scene();
    add_objects(only);
    rtcCommitScene(top);
  }
  ~Rays() {
    rtcReleaseScene(top);
    for (RTCScene mesh : meshes)
      if (mesh != nullptr) rtcReleaseScene(mesh);
    rtcReleaseDevice(device);
  }
  Rays(const Rays&) = delete;
  Rays& operator=(const Rays&) = delete;

  RTCScene new_scene() const {
    RTCScene result = rtcNewScene(device);
    rtcSetSceneFlags(result, RTC_SCENE_FLAG_ROBUST);
    return result;
  }

  /// Objects become triangles of their own where that fits, which is faster and needs no rounding of rays into mesh
  /// space; shared meshes of large scenes become instances.
  void add_objects(const VisibleSet* only) {
    std::vector<std::uint32_t> uses(scene.meshes().size(), 0);
    for (const Object& object : scene.objects()) ++uses[object.mesh];
    meshes.assign(scene.meshes().size(), nullptr);
    const bool small = scene.triangle_count() <= most_triangles_copied;
    for (ObjectId id = 0; id < scene.objects().size(); ++id) {
      const Object& object = scene.objects()[id];
      const Mesh& mesh = scene.meshes()[object.mesh];
      if (mesh.triangles.empty() || (only != nullptr && !only->contains(id))) continue;
      if (small || uses[object.mesh] == 1) {
        attach(top, triangles_of(mesh, object.transform), id);
      } else {
        if (meshes[object.mesh] == nullptr) meshes[object.mesh] = scene_of(mesh);
        attach(top, instance_of(meshes[object.mesh], object.transform), id);
      }
    }
  }

  static void attach(RTCScene to, RTCGeometry geometry, unsigned id) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(to, geometry, id);
    rtcReleaseGeometry(geometry);
  }

  RTCGeometry triangles_of(const Mesh& mesh, const Affine& transform) const {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), mesh.positions.size()));
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) vertices[i] = transform_point(transform, mesh.positions[i]);
    auto* indices = static_cast<glm::uvec3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3), mesh.triangles.size()));
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), indices);
    return geometry;
  }

  RTCScene scene_of(const Mesh& mesh) const {
    RTCScene result = new_scene();
    attach(result, triangles_of(mesh, identity_affine()), 0);
    rtcCommitScene(result);
    return result;
  }

  RTCGeometry instance_of(RTCScene mesh, const Affine& transform) const {
    RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, mesh);
    rtcSetGeometryTimeStepCount(instance, 1);
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, &transform[0].x);
    return instance;
  }

  void trace(Packet& packet) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(packet.valid, top, &context, &packet.rays);
  }

  /// Follows the packet's rays; calls seen(lane, object) for every surface up to the first opaque one, or, with
  /// `through`, for every surface.
  template <class Seen>
  void follow(Packet& packet, float t_far, Seen&& seen, bool through = false) const {
    for (bool more = true; more;) {
      trace(packet);
      more = false;
      for (int lane = 0; lane < lanes; ++lane) {
        if (packet.valid[lane] == 0) continue;
        packet.valid[lane] = 0;
        const ObjectId id = packet.object(lane);
        if (id == no_object) continue;
        seen(lane, id);
        if (!through && scene.objects()[id].opaque) continue;
        advance(packet, lane, t_far);
        more = true;
      }
    }
  }

  /// Lets a ray go on behind its hit.
  static void advance(Packet& packet, int lane, float t_far) {
    RTCRay16& ray = packet.rays.ray;
    ray.tnear[lane] = std::nextafter(ray.tfar[lane], std::numeric_limits<float>::infinity());
    ray.tfar[lane] = t_far;
    packet.rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    packet.rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    packet.valid[lane] = -1;
  }

  const Scene& scene;
  RTCDevice device = nullptr;
  RTCScene top = nullptr;
  std::vector<RTCScene> meshes;
};

namespace {

/// Calls block(x0, y0, x1, y1) for the tiles that touch `part` of an image of width x height samples, on all threads.
template <class Block>
void for_tiles(int width, int height, const SampleRect& part, Block&& block) {
  if (part.empty()) return;
  const int left = part.x0 / tile * tile, top = part.y0 / tile * tile;
  const int across = (part.x1 - left + tile - 1) / tile, down = (part.y1 - top + tile - 1) / tile;
  const auto count = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
  parallel_blocks(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int x = left + static_cast<int>(i % static_cast<std::size_t>(across)) * tile;
      const int y = top + static_cast<int>(i / static_cast<std::size_t>(across)) * tile;
      block(x, y, std::min(x + tile, width), std::min(y + tile, height));
    }
  });
}

template <class Block>
void for_tiles(int width, int height, Block&& block) {
  for_tiles(width, height, {0, 0, width, height}, block);
}

/// Calls packet(x, y) for the 4 x 4 groups of samples of a block; a group may hang over the edge of the image.
template <class Group>
void for_groups(int x0, int y0, int x1, int y1, Group&& group) {
  for (int y = y0; y < y1; y += 4)
    for (int x = x0; x < x1; x += 4) group(x, y);
}

}  // namespace

Oracle::Oracle(const Scene& scene) : rays_(std::make_unique<Rays>(scene, nullptr)) {}
Oracle::Oracle(const Scene& scene, const VisibleSet& only) : rays_(std::make_unique<Rays>(scene, &only)) {
  assert(only.universe() == scene.objects().size());
}
Oracle::~Oracle() = default;

Truth Oracle::look(const View& view, int samples_per_axis) const {
  assert(samples_per_axis >= 1);
  const RayBasis basis(view);
  const std::size_t objects = rays_->scene.objects().size();
  std::vector<std::atomic<std::uint32_t>> counts(objects);
  const int width = view.width * samples_per_axis, height = view.height * samples_per_axis;
  const double step = 1.0 / samples_per_axis;
  for_tiles(width, height, [&](int x0, int y0, int x1, int y1) {
    std::array<std::vector<ObjectId>, lanes> passed;
    ObjectId last = no_object;  // neighbours mostly see the same object: count runs, add once
    std::uint32_t run = 0;
    const auto flush = [&] {
      if (run > 0) counts[last].fetch_add(run, std::memory_order_relaxed);
    };
    for_groups(x0, y0, x1, y1, [&](int gx, int gy) {
      Packet packet{};
      for (int lane = 0; lane < lanes; ++lane) {
        const int x = gx + lane % 4, y = gy + lane / 4;
        if (x < x1 && y < y1) basis.set(packet, lane, (x + 0.5) * step, (y + 0.5) * step);
      }
      for (auto& list : passed) list.clear();
      rays_->follow(packet, basis.t_far, [&](int lane, ObjectId id) {
        if (!rays_->scene.objects()[id].opaque) {  // a ray enters and leaves a glass box, which is seen once
          auto& list = passed[static_cast<std::size_t>(lane)];
          if (std::find(list.begin(), list.end(), id) != list.end()) return;
          list.push_back(id);
        }
        if (id != last) {
          flush();
          last = id;
          run = 0;
        }
        ++run;
      });
    });
    flush();
  });

  Truth truth{VisibleSet(objects), std::vector<std::uint32_t>(objects), samples_per_axis};
  for (std::size_t id = 0; id < objects; ++id) {
    truth.samples[id] = counts[id].load(std::memory_order_relaxed);
    if (truth.samples[id] > 0) truth.seen.insert(static_cast<ObjectId>(id));
  }
  return truth;
}

void Oracle::trace(const View& view, int samples_per_axis, const SampleRect& part, const SampleSink& sample) const {
  const RayBasis basis(view);
  const double step = 1.0 / samples_per_axis;
  const auto inside = [&](int x, int y) { return x >= part.x0 && x < part.x1 && y >= part.y0 && y < part.y1; };
  for_tiles(view.width * samples_per_axis, view.height * samples_per_axis, part, [&](int x0, int y0, int x1, int y1) {
    std::array<std::vector<SurfaceHit>, lanes> hits;
    for_groups(x0, y0, x1, y1, [&](int gx, int gy) {
      // Whole groups, as look() has them: Embree's answers at edges may depend on what else is in the packet.
      Packet packet{};
      for (int lane = 0; lane < lanes; ++lane) {
        hits[static_cast<std::size_t>(lane)].clear();
        const int x = gx + lane % 4, y = gy + lane / 4;
        if (x < x1 && y < y1) basis.set(packet, lane, (x + 0.5) * step, (y + 0.5) * step);
      }
      rays_->follow(packet, basis.t_far, [&](int lane, ObjectId id) {
        hits[static_cast<std::size_t>(lane)].push_back({id, packet.rays.hit.primID[lane], packet.rays.ray.tfar[lane]});
      });
      for (int lane = 0; lane < lanes; ++lane) {
        const int x = gx + lane % 4, y = gy + lane / 4;
        if (x < x1 && y < y1 && inside(x, y)) sample(x, y, hits[static_cast<std::size_t>(lane)]);
      }
    });
  });
}

std::vector<std::uint8_t> Oracle::count_surfaces(const View& view) const {
  std::vector<std::uint8_t> counts(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
  const RayBasis basis(view);
  for_tiles(view.width, view.height, [&](int x0, int y0, int x1, int y1) {
    for_groups(x0, y0, x1, y1, [&](int gx, int gy) {
      Packet packet{};
      std::array<std::uint8_t*, lanes> count{};
      for (int lane = 0; lane < lanes; ++lane) {
        const int x = gx + lane % 4, y = gy + lane / 4;
        if (x >= x1 || y >= y1) continue;
        basis.set(packet, lane, x + 0.5, y + 0.5);
        count[static_cast<std::size_t>(lane)] =
            &counts[static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x)];
      }
      const auto add = [&](int lane, ObjectId) {
        std::uint8_t& n = *count[static_cast<std::size_t>(lane)];
        if (n < 255) ++n;
      };
      rays_->follow(packet, basis.t_far, add, true);
    });
  });
  return counts;
}

void Oracle::draw(const View& view, Frame& frame) const {
  frame.clear(view.width, view.height);
  const RayBasis basis(view);
  for_tiles(view.width, view.height, [&](int x0, int y0, int x1, int y1) {
    for_groups(x0, y0, x1, y1, [&](int gx, int gy) {
      Packet packet{};
      for (int lane = 0; lane < lanes; ++lane) {
        const int x = gx + lane % 4, y = gy + lane / 4;
        if (x < x1 && y < y1) basis.set(packet, lane, x + 0.5, y + 0.5);
      }
      rays_->trace(packet);
      for (int lane = 0; lane < lanes; ++lane) {
        const ObjectId id = packet.valid[lane] != 0 ? packet.object(lane) : no_object;
        if (id == no_object) continue;
        const std::size_t at = frame.index(gx + lane % 4, gy + lane / 4);
        frame.object[at] = id;
        frame.triangle[at] = packet.rays.hit.primID[lane];
        frame.depth[at] = packet.rays.ray.tfar[lane];
      }
    });
  });
}

Verdict judge(const Truth& truth, const VisibleSet& visible) {
  Verdict verdict;
  verdict.truth = truth.seen.count();
  verdict.missed = set_difference(truth.seen, visible).sorted();
  for (const ObjectId id : verdict.missed) verdict.missed_samples += truth.samples[id];
  verdict.extra = visible.count() - (verdict.truth - verdict.missed.size());
  return verdict;
}

}  // namespace sightline
