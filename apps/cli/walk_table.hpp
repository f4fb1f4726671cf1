// A walk as text for a person.
#pragma once

#include <string>

#include "walk_report.hpp"

namespace sightline::cli {

/// One method: a row for each frame. Several: a row for each method.
std::string walk_table(const WalkReport& report);

}  // namespace sightline::cli
