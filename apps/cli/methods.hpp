// The one place where the tables of algorithms are joined: the library's, and those of the parts that need a device.
#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/core/algorithm.hpp"
#include "sightline/oracle/oracle.hpp"

namespace sightline::cli {

/// A method cannot run on this machine (no OpenGL, ...); what() is one line. Its row is skipped, or the program ends
/// with exit code 4 if nothing else was asked for.
class MethodUnavailable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The rows of all tables, the library's first.
const std::vector<Algorithm>& all_algorithms();

/// The row of that name in any table. Throws InputError that lists the names of the family if there is none.
const Algorithm& find_method(std::string_view name, Family family);

/// As make_culler of the library, for every table. Throws InputError, MethodUnavailable.
std::unique_ptr<Culler> make_any_culler(std::string_view text, const IndexedScene& scene);

/// The truth that the promise of a culler speaks of where that is not the oracle's: what OpenGL itself shows of the
/// whole scene, as it snaps vertices to a grid and rays do not. Null for cullers of the library. `drawn` keeps it for
/// the other methods of the frame.
const Truth* own_truth(Culler& culler, const View& view, std::optional<Truth>& drawn);

/// Starts to collect the timeline of a culler that has one; false if it has none.
bool start_trace(Culler& culler);
/// What was collected, as a trace for chrome://tracing, or the last frame as an SVG; empty if nothing was.
std::string finish_trace(Culler& culler, const std::string& name, bool as_picture);

}  // namespace sightline::cli
