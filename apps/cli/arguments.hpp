// Values as a person types them on the command line. All functions throw UsageError that names the option, the text and
// what was expected.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "options.hpp"

namespace sightline::cli {

/// A whole number in [low, high].
std::uint64_t parse_whole(std::string_view option, std::string_view text, std::uint64_t low, std::uint64_t high);

/// A number that is neither infinite nor NaN.
double parse_finite(std::string_view option, std::string_view text);

/// A number above zero; "inf" only if `may_be_infinite`.
double parse_positive(std::string_view option, std::string_view text, bool may_be_infinite = false);

/// A number from 0 to 1.
double parse_share(std::string_view option, std::string_view text);

/// "x,y,z", finite.
glm::dvec3 parse_vector(std::string_view option, std::string_view text);

/// "WIDTHxHEIGHT" in pixels, each 1 to 16384.
std::pair<int, int> parse_size(std::string_view option, std::string_view text);

/// The parts between commas; an empty part is an error.
std::vector<std::string> parse_names(std::string_view option, std::string_view text);

/// "auto", "json" or "none".
ProgressKind parse_progress(std::string_view option, std::string_view text);

/// "X,Y", whole numbers from 0: a pixel.
std::pair<int, int> parse_pixel(std::string_view option, std::string_view text);

}  // namespace sightline::cli
