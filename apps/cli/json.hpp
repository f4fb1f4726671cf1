// JSON as the tool writes it: members keep their order.
#pragma once

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

namespace sightline::cli {

using Json = nlohmann::ordered_json;

/// [x, y, z]; floats with as many digits as a float has.
template <class T>
Json vector_json(const glm::vec<3, T>& v) {
  return {v.x, v.y, v.z};
}

}  // namespace sightline::cli
