// Whether the back faces of a mesh can never be seen from outside: it must be closed, consistently oriented and turned
// outwards (checklist 17.01, 17.06). What is not, face cullers leave alone.
#pragma once

#include <span>
#include <string_view>

#include "sightline/scene/scene.hpp"

namespace sightline {

enum class Solidity {
  solid,    // closed, oriented, every part encloses a volume with its faces outwards: back faces may be culled
  open,     // an edge without exactly two triangles of opposite direction: holes, or faces turned either way
  inverted  // closed, but a connected part has its faces inwards (a room, a cavity, a wrong winding)
};

/// Decides by edges that are shared by position (Mesh::closed) and by the signed volume of every connected part. A part
/// of no volume (two coincident sheets) counts as turned outwards. Surfaces that run through themselves inside out are
/// not recognised. O(n log n).
Solidity solidity_of(const Mesh& mesh);

std::string_view to_string(Solidity solidity);

}  // namespace sightline
