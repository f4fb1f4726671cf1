// Whole files into memory, and texts of other libraries into one line of an error message.
#include "sightline/scene/load/file_bytes.hpp"

#include <algorithm>
#include <fstream>

#include "sightline/scene/input_error.hpp"

namespace sightline {

namespace {

constexpr std::size_t longest_message = 300;

std::uint64_t regular_file_size(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw InputError(file.string(), "", "no such file");
  if (std::filesystem::is_directory(status)) throw InputError(file.string(), "", "is a directory, not a file");
  if (!std::filesystem::is_regular_file(status)) throw InputError(file.string(), "", "is not a regular file");
  const std::uint64_t size = std::filesystem::file_size(file, error);
  if (error) throw InputError(file.string(), "", "cannot be read: " + error.message());
  return size;
}

}  // namespace

Bytes read_file(const std::filesystem::path& file, std::uint64_t limit) {
  Bytes bytes(static_cast<std::size_t>(std::min(regular_file_size(file), limit)));
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file.string(), "", "cannot be opened for reading");
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::size_t>(stream.gcount()) != bytes.size()) {
    throw InputError(file.string(), "byte " + std::to_string(stream.gcount()), "cannot be read any further");
  }
  return bytes;
}

std::string one_line(std::string_view text) {
  std::string line;
  for (const char c : text.substr(0, longest_message)) {
    const bool blank = static_cast<unsigned char>(c) <= ' ' || c == '\x7f';
    if (!blank) {
      line += c;
    } else if (!line.empty() && line.back() != ' ') {
      line += ' ';
    }
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  return line;
}

std::string in_quotes(std::string_view text) {
  std::string result = one_line(text);
  result.insert(result.begin(), '\'');
  result += '\'';
  return result;
}

}  // namespace sightline
