// The report of a walk: one self-contained page, the page of web/ with the walk's data in it.
#pragma once

#include <filesystem>
#include <string>

#include "walk_report.hpp"

namespace sightline::cli {

/// Makes the folder and sees that a file can be written there. Throws InputError.
void prepare_report(const std::filesystem::path& folder);

/// Writes folder/index.html. Throws InputError if it cannot be written.
void write_report(const WalkReport& report, const std::filesystem::path& folder);

/// `json` so that it can stand inside a <script>: "</script" and "<!--" cannot occur.
std::string script_safe(std::string_view json);

}  // namespace sightline::cli
