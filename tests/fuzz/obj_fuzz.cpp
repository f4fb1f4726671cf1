// Any bytes as an OBJ file; what follows the first byte 1 is the material file "m" beside it.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "reader.hpp"

namespace {

/// A folder of this process for the material file.
const std::filesystem::path& folder() {
  static const std::filesystem::path path = [] {
    std::string name = (std::filesystem::temp_directory_path() / "fuzz-obj-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    return std::filesystem::path(name);
  }();
  return path;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace sightline;
  const unsigned char* end = data + size;
  const unsigned char* mark = std::find(data, end, static_cast<unsigned char>(1));
  if (mark != end) {
    std::ofstream(folder() / "m", std::ios::binary)
        .write(reinterpret_cast<const char*>(mark + 1), static_cast<std::streamsize>(end - mark - 1));
  }
  const Bytes bytes = fuzz::bytes_of(data, static_cast<std::size_t>(mark - data));
  return fuzz::expect_one_line([&] { fuzz::expect_sound(read_obj(folder() / "scene.obj", bytes).scene); });
}
