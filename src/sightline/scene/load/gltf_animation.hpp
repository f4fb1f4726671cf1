// Animations of a glTF file as far as they move cameras: transforms of nodes over time.
// Source: glTF 2.0 specification, section 3.11 and appendix C (interpolation modes).
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <optional>
#include <vector>

#include "sightline/scene/load/gltf_document.hpp"

namespace sightline {

enum class GltfInterpolation { step, linear, cubic };

/// Values of `components` numbers at ascending times (seconds); cubic ones have three values a time: tangent towards
/// it, the value, tangent away from it.
struct GltfTrack {
  GltfInterpolation interpolation = GltfInterpolation::linear;
  int components = 3;
  std::vector<float> times, values;

  /// The value at a time, held before the first and after the last one. Quaternions (four components) are turned on the
  /// shortest way and have unit length.
  [[nodiscard]] glm::dvec4 at(double seconds) const;
};

/// What a node does over time; without a track it keeps what it has in the file.
struct GltfMotion {
  std::optional<GltfTrack> translation, rotation, scale;

  [[nodiscard]] bool moves() const { return translation || rotation || scale; }
};

/// A node on the way from the root to a camera.
struct GltfLink {
  glm::dmat4 rest;                          // local matrix without animation
  glm::dvec3 translation{0.0}, scale{1.0};  // its parts, where it is animated
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
  GltfMotion motion;

  [[nodiscard]] glm::dmat4 at(double seconds) const;
};

/// Tracks of the nodes of all animations; of two for the same property the first counts. Throws InputError.
std::map<std::size_t, GltfMotion> read_motions(GltfDocument& document, std::size_t& channels);

/// The node for animation. Throws InputError if it is animated and given as a matrix (section 3.11 forbids it).
GltfLink read_link(const JsonObject& node, const GltfMotion* motion);

}  // namespace sightline
