// Back-face culling of whole clusters (Johannsen and Carter 1998, Kumar 1996, checklist 19). Promise:
// conservative-continuous.
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

/// Parameters: docs/algorithms/cluster_backface.md. Throws InputError.
std::unique_ptr<FaceCuller> make_cluster_backface(const IndexedScene& scene, ParameterReader& parameters);

/// t_C / r of the cost model (19.16): measured on this machine at the first call, rounded to a power of two, and kept
/// in the user's cache folder (core/kept_number.hpp). Threads may call it at once.
double measured_cluster_cost();

}  // namespace sightline
