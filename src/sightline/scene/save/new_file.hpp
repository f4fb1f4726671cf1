// A file that appears whole or not at all: written under a temporary name in the same folder, then renamed.
#pragma once

#include <filesystem>
#include <fstream>
#include <string_view>

namespace sightline {

class NewFile {
 public:
  /// Opens the temporary file. Throws InputError(path) if the folder cannot be written.
  explicit NewFile(std::filesystem::path path);
  /// Removes the temporary file unless commit() has renamed it.
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void write(std::string_view bytes) { stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); }

  /// Puts the file in its place, over any file of that name. Throws InputError if not all could be written.
  void commit();

 private:
  std::filesystem::path path_, temporary_;
  std::ofstream stream_;
};

}  // namespace sightline
