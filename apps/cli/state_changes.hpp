// State changes between drawing and querying, frame by frame, of the methods that ask one by one and of the one that
// asks in batches (checklist 22.13, 22.17).
#pragma once

#include <string>

#include "json_output.hpp"
#include "options.hpp"

namespace sightline::cli {

/// Walks through options.scene and returns {"schema", "scene", "frames", "methods": [{"method", "state_changes": [one a
/// frame], "queries": [...]}]}; interrupted, what there is of it. Throws InputError, MethodUnavailable.
Json measure_state_changes(const QueriesOptions& options);

/// The curves of it: an SVG, the number of changes as a power of two.
std::string state_changes_svg(const Json& measured);

}  // namespace sightline::cli
