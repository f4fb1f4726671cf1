// Embree over the triangles of a soup as one geometry, ray by ray: what our structures stand beside.
#pragma once

#include <embree3/rtcore.h>

#include <algorithm>

#include "sightline/index/trace.hpp"

namespace sightline {

class EmbreeRays {
 public:
  /// `device`: Embree's configuration, null for its default (all threads build).
  EmbreeRays(const TriangleSoup& soup, RTCSceneFlags flags, const char* device = nullptr)
      : device_(rtcNewDevice(device)), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, flags);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), soup.corners.size()));
    std::copy(soup.corners.begin(), soup.corners.end(), vertices);
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, soup.size()));
    for (std::uint32_t i = 0; i < 3 * soup.size(); ++i) indices[i] = i;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
  }
  ~EmbreeRays() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeRays(const EmbreeRays&) = delete;
  EmbreeRays& operator=(const EmbreeRays&) = delete;

  /// Builds the hierarchy; before any ray.
  void build() { rtcCommitScene(scene_); }

  [[nodiscard]] RayHit nearest(const Ray& ray) const {
    RTCRayHit r;
    set(r.ray, ray);
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &r);
    if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {r.ray.tfar, r.hit.primID};
  }
  [[nodiscard]] bool any(const Ray& ray) const {
    RTCRay r;
    set(r, ray);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_, &context, &r);
    return r.tfar < 0.0f;
  }

 private:
  static void set(RTCRay& r, const Ray& ray) {
    r.org_x = ray.origin.x;
    r.org_y = ray.origin.y;
    r.org_z = ray.origin.z;
    r.dir_x = ray.direction.x;
    r.dir_y = ray.direction.y;
    r.dir_z = ray.direction.z;
    r.tnear = ray.t_near;
    r.tfar = ray.t_far;
    r.time = 0.0f;
    r.mask = 0xFFFFFFFFu;
    r.id = 0;
    r.flags = 0;
  }
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace sightline
