#include "sightline/core/kept_number.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <system_error>

namespace sightline {
namespace {

namespace fs = std::filesystem;

/// Empty if the user has none.
fs::path cache_folder() {
  const char* const cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && fs::path(cache).is_absolute()) return fs::path(cache) / "sightline";
  const char* const home = std::getenv("HOME");
  if (home != nullptr && fs::path(home).is_absolute()) return fs::path(home) / ".cache" / "sightline";
  return {};
}

void keep(const fs::path& file, double number) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error) return;
  fs::path temporary = file;
  temporary += "." + std::to_string(std::random_device()());
  {
    std::ofstream stream(temporary);
    stream.precision(17);
    stream << number << '\n';
    stream.close();
    if (stream) fs::rename(temporary, file, error);
    if (stream && !error) return;
  }
  fs::remove(temporary, error);
}

}  // namespace

double kept_number(const std::string& name, double least, double most, const std::function<double()>& measure) {
  const fs::path folder = cache_folder();
  if (folder.empty()) return measure();
  double number = 0.0;
  if (std::ifstream(folder / name) >> number && number >= least && number <= most) return number;
  number = measure();
  keep(folder / name, number);
  return number;
}

}  // namespace sightline
