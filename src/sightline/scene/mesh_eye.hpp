// The eye of a view in the space of a mesh, with what rounding may do to the question which side of a triangle it sees.
// Working in mesh space makes mirrored objects no special case: what is outside stays outside.
#pragma once

#include "sightline/scene/view.hpp"

namespace sightline {

/// A triangle with unit normal n, plane offset d = n . p and least height h, all relative to the centre of the mesh's
/// bounds, turns its back for sure if n . eye.xyz - d * eye.w <= -(slack + sharpness / h): in exact arithmetic and for
/// the float corners that transform_point makes (17.03, E35).
struct MeshEye {
  glm::vec4 eye{0.0f};     // perspective: the eye, w = 1; orthographic: the unit direction towards it, w = 0
  float slack = 0.0f;      // distance (orthographic: sine of an angle)
  float sharpness = 0.0f;  // times distance (orthographic: times sine)
  /// False if the object's transform is singular or too crooked to tell: nothing may be culled.
  bool valid = false;
};

MeshEye mesh_eye(const View& view, const Object& object, const Mesh& mesh);

/// World-space directions into mesh space, times any positive number (double precision inverse of the linear part).
/// False if the transform is singular or too crooked.
bool inverse_linear(const Affine& transform, glm::dmat3& inverse);

}  // namespace sightline
