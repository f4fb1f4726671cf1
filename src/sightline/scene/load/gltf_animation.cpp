#include "sightline/scene/load/gltf_animation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "sightline/scene/load/gltf_accessor.hpp"
#include "sightline/scene/load/gltf_node.hpp"

namespace sightline {

namespace {

glm::dvec4 element(const GltfTrack& track, std::size_t index) {
  glm::dvec4 value(0.0);
  const auto components = static_cast<std::size_t>(track.components);
  for (std::size_t c = 0; c < components; ++c) value[static_cast<int>(c)] = track.values[index * components + c];
  return value;
}

glm::dquat to_quaternion(const glm::dvec4& v) { return {v.w, v.x, v.y, v.z}; }

glm::dvec4 unit(const glm::dvec4& v) {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : glm::dvec4(0.0, 0.0, 0.0, 1.0);
}

glm::dvec4 turn(const glm::dvec4& from, const glm::dvec4& to, double t) {
  const glm::dquat q = glm::slerp(to_quaternion(unit(from)), to_quaternion(unit(to)), t);
  return {q.x, q.y, q.z, q.w};
}

/// Hermite (appendix C.4); the tangents are per second.
glm::dvec4 hermite(const GltfTrack& track, std::size_t i, double t, double span) {
  const glm::dvec4 p0 = element(track, 3 * i + 1), m0 = span * element(track, 3 * i + 2);
  const glm::dvec4 m1 = span * element(track, 3 * i + 3), p1 = element(track, 3 * i + 4);
  const double t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * p0 + (t3 - 2 * t2 + t) * m0 + (3 * t2 - 2 * t3) * p1 + (t3 - t2) * m1;
}

GltfInterpolation interpolation_of(const JsonObject& sampler) {
  const std::string& text = sampler.text("interpolation");
  if (text.empty() || text == "LINEAR") return GltfInterpolation::linear;
  if (text == "STEP") return GltfInterpolation::step;
  if (text == "CUBICSPLINE") return GltfInterpolation::cubic;
  sampler.fail("interpolation", in_quotes(text) + " is none of LINEAR, STEP, CUBICSPLINE");
}

GltfTrack read_track(GltfDocument& document, const JsonObject& sampler, int components) {
  const std::size_t accessors = document.count("accessors");
  const auto input = sampler.reference("input", accessors), output = sampler.reference("output", accessors);
  if (!input || !output) sampler.fail("needs input and output");
  GltfTrack track{interpolation_of(sampler), components, read_floats(document, *input, 1),
                  read_floats(document, *output, components)};
  if (track.times.empty()) sampler.fail("input", "has no times");
  for (std::size_t i = 1; i < track.times.size(); ++i)
    if (!(track.times[i] > track.times[i - 1])) sampler.fail("input", "the times do not ascend");
  const std::size_t values = track.times.size() * (track.interpolation == GltfInterpolation::cubic ? 3u : 1u);
  if (track.values.size() != values * static_cast<std::size_t>(components))
    sampler.fail("output", "has not as many elements as there are times");
  return track;
}

void read_channel(GltfDocument& document, const JsonObject& animation, const JsonObject& channel,
                  std::map<std::size_t, GltfMotion>& motions) {
  const auto sampler = channel.reference("sampler", animation.count("samplers"));
  if (!sampler) channel.fail("sampler", "is missing");
  const std::optional<JsonObject> target = channel.object("target");
  if (!target) channel.fail("target", "is missing");
  const auto node = target->reference("node", document.count("nodes"));
  if (!node) return;  // the target is in an extension
  GltfMotion& motion = motions[*node];
  const std::string& path = target->text("path");
  std::optional<GltfTrack>* const track = path == "translation" ? &motion.translation
                                          : path == "rotation"  ? &motion.rotation
                                          : path == "scale"     ? &motion.scale
                                                                : nullptr;
  if (track != nullptr && !*track)
    *track = read_track(document, animation.item("samplers", *sampler), path == "rotation" ? 4 : 3);
}

}  // namespace

glm::dvec4 GltfTrack::at(double seconds) const {
  const bool cubic = interpolation == GltfInterpolation::cubic;
  const bool turns = components == 4;
  const auto key = [&](std::size_t i) {
    const glm::dvec4 value = element(*this, cubic ? 3 * i + 1 : i);
    return turns ? unit(value) : value;
  };
  const auto after = std::upper_bound(times.begin(), times.end(), static_cast<float>(seconds));
  if (after == times.begin()) return key(0);
  const auto i = static_cast<std::size_t>(after - times.begin()) - 1;
  if (after == times.end() || interpolation == GltfInterpolation::step) return key(i);
  const double span = static_cast<double>(times[i + 1]) - static_cast<double>(times[i]);
  const double t = std::clamp((seconds - static_cast<double>(times[i])) / span, 0.0, 1.0);
  if (cubic) return turns ? unit(hermite(*this, i, t, span)) : hermite(*this, i, t, span);
  return turns ? turn(key(i), key(i + 1), t) : glm::mix(key(i), key(i + 1), t);
}

glm::dmat4 GltfLink::at(double seconds) const {
  if (!motion.moves()) return rest;
  const glm::dvec3 t = motion.translation ? glm::dvec3(motion.translation->at(seconds)) : translation;
  const glm::dvec3 s = motion.scale ? glm::dvec3(motion.scale->at(seconds)) : scale;
  const glm::dquat r = motion.rotation ? to_quaternion(motion.rotation->at(seconds)) : rotation;
  const glm::dmat3 axes = glm::mat3_cast(r);
  return {glm::dvec4(axes[0] * s.x, 0.0), glm::dvec4(axes[1] * s.y, 0.0), glm::dvec4(axes[2] * s.z, 0.0),
          glm::dvec4(t, 1.0)};
}

std::map<std::size_t, GltfMotion> read_motions(GltfDocument& document, std::size_t& channels) {
  std::map<std::size_t, GltfMotion> motions;
  channels = 0;
  for (std::size_t a = 0; a < document.count("animations"); ++a) {
    const JsonObject animation = document.item("animations", a);
    for (std::size_t c = 0; c < animation.count("channels"); ++c, ++channels)
      read_channel(document, animation, animation.item("channels", c), motions);
  }
  return motions;
}

GltfLink read_link(const JsonObject& node, const GltfMotion* motion) {
  GltfLink link;
  link.rest = node_matrix(node);
  if (motion == nullptr || !motion->moves()) return link;
  if (node.has("matrix")) node.fail("matrix", "an animated node must have translation, rotation and scale instead");
  std::array<double, 3> t{0.0, 0.0, 0.0}, s{1.0, 1.0, 1.0};
  std::array<double, 4> r{0.0, 0.0, 0.0, 1.0};
  node.numbers("translation", t);
  node.numbers("scale", s);
  node.numbers("rotation", r);
  link.translation = {t[0], t[1], t[2]};
  link.scale = {s[0], s[1], s[2]};
  link.rotation = to_quaternion(unit({r[0], r[1], r[2], r[3]}));
  link.motion = *motion;
  return link;
}

}  // namespace sightline
