// A file that appears whole or not at all: written under a temporary name in the same folder, then renamed.
#include "sightline/scene/save/new_file.hpp"

#include <random>
#include <string>

#include "sightline/scene/input_error.hpp"

namespace sightline {

NewFile::NewFile(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code error;
  if (std::filesystem::is_directory(path_, error)) throw InputError(path_.string(), "", "is a directory");
  // A link keeps its place and its target is replaced; a device or pipe must not become a file.
  if (std::filesystem::is_symlink(path_, error)) path_ = std::filesystem::weakly_canonical(path_, error);
  if (std::filesystem::exists(path_, error) && !std::filesystem::is_regular_file(path_, error))
    throw InputError(path_.string(), "", "is not a regular file");
  temporary_ = path_;
  temporary_ += '.';
  temporary_ += std::to_string(std::random_device()());
  temporary_ += ".part";
  stream_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!stream_) throw InputError(path_.string(), "", "cannot be written");
}

NewFile::~NewFile() {
  if (temporary_.empty()) return;
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void NewFile::commit() {
  stream_.close();
  if (!stream_) throw InputError(path_.string(), "", "could not be written to its end");
  std::error_code error;
  std::filesystem::rename(temporary_, path_, error);
  if (error) throw InputError(path_.string(), "", "cannot be put in place: " + error.message());
  temporary_.clear();
}

}  // namespace sightline
