// The plain z-buffer (Strasser 1974, Catmull 1974; checklist 3.01-3.05 with E4, E5): every triangle, every pixel of its
// box, edge functions with the top-left rule, in double precision. Promise: exact up to the stated depth error; ties of
// depth go to the lower object, then the lower triangle. The readable reference, not the fast one.
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

std::unique_ptr<Renderer> make_zbuffer(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
