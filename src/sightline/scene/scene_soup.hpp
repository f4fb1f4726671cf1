// A scene as triangles in world space, for tracing.
#pragma once

#include <span>

#include "sightline/index/triangle_soup.hpp"
#include "sightline/scene/scene.hpp"

namespace sightline {

/// The triangles of all objects, or of those listed (ascending ids), instances each their own; corners rounded as
/// transform_point does. Throws InputError above 2^28 triangles.
TriangleSoup soup_of(const Scene& scene);
TriangleSoup soup_of(const Scene& scene, std::span<const ObjectId> objects);

}  // namespace sightline
