// A number that is measured once on a machine and kept in the user's cache folder (checklist 19.16).
#pragma once

#include <functional>
#include <string>

namespace sightline {

/// The number in the file `name` of $XDG_CACHE_HOME/sightline (~/.cache/sightline if that is not set) if it lies within
/// [least, most]; else that of measure(), which is then kept there: written under a temporary name and renamed. A file
/// that is missing, unreadable, nonsense or cannot be written is no error; the number is measured.
double kept_number(const std::string& name, double least, double most, const std::function<double()>& measure);

}  // namespace sightline
