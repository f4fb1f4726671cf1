// Recursive ray tracing (Appel 1968, Whitted 1980; checklist 13.02, 13.03 with E22, E23): shadows, mirrors, glass.
// Promise: ids and depth are exact, those of the nearest surface at every pixel centre, opaque or not; colour is a
// model. Transparent surfaces add their share and let the ray go on with the rest (E22), instead of stopping it.
#pragma once

#include <memory>
#include <vector>

#include "sightline/core/algorithm.hpp"

namespace sightline {

/// How a surface looks. Shares are 0 to 1; what is neither reflected nor let through is the surface's own colour.
struct WhittedMaterial {
  glm::vec3 colour{0.8f};
  float ambient = 0.25f, diffuse = 0.75f;  // of the own colour
  float highlight = 0.2f, shininess = 40;  // Phong's, of the light's colour
  float reflect = 0.0f;                    // share of the mirrored ray
  float transmit = 0.0f;                   // 1 - alpha: share of what lies behind
  float index = 1.0f;                      // of refraction; 1: straight on
};

struct WhittedLight {
  glm::dvec3 position{0.0};  // world, metres; a direction towards the light if `distant`
  bool distant = true;
  glm::vec3 colour{1.0f};
};

struct WhittedConfig {
  /// By object; objects beyond the end get defaults: a colour by id, glass (transmit 0.75, index 1) if not opaque.
  std::vector<WhittedMaterial> materials;
  /// None: one distant light from above.
  std::vector<WhittedLight> lights;
  glm::vec3 sky{0.55f, 0.68f, 0.85f};
  int depth = 6;  // reflections and refractions one after another, 0 to 32
  bool shadows = true;
  double reflect = 0.0;  // of default materials of opaque objects, 0 to 1
  double index = 1.0;    // of default glass, 1 to 3
};

std::unique_ptr<Renderer> make_whitted(const Scene& scene, const WhittedConfig& config);
std::unique_ptr<Renderer> make_whitted_row(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
