// The page of the report with the marker that the data replaces; embedded by the build.
#pragma once

#include <string_view>

namespace sightline::cli {

std::string_view page_template();

}  // namespace sightline::cli
