// Whole files into memory, and texts of other libraries into one line of an error message.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace sightline {

using Bytes = std::vector<std::byte>;

/// The first `limit` bytes of a regular file, or all of it if it is shorter.
/// Throws InputError (file, "", reason) if it is missing, a directory, or cannot be read.
Bytes read_file(const std::filesystem::path& file, std::uint64_t limit = UINT64_MAX);

/// `text` without line breaks and control characters, cut after 300 bytes: fit for a one-line message.
std::string one_line(std::string_view text);

/// The same between single quotes.
std::string in_quotes(std::string_view text);

}  // namespace sightline
