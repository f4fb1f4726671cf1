// Any bytes as a file of one of the formats that come through assimp; the first byte chooses which. The library runs in
// a process of its own: what is tested is that whatever it does there ends as a sound scene or an error of one line.
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include "reader.hpp"

namespace {

/// A folder of this process for the files.
const std::filesystem::path& folder() {
  static const std::filesystem::path path = [] {
    std::string name = (std::filesystem::temp_directory_path() / "fuzz-assimp-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    return std::filesystem::path(name);
  }();
  return path;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace sightline;
  static constexpr std::array<const char*, 6> names = {"p.ply", "s.stl", "d.dae", "f.fbx", "3.3ds", "i.ifc"};
  if (size == 0) return 0;
  const char* const* name = std::find_if(names.begin(), names.end(), [&](const char* n) { return n[0] == data[0]; });
  if (name == names.end()) return 0;
  const std::filesystem::path file = folder() / *name;
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
  return fuzz::expect_one_line([&] { fuzz::expect_sound(read_with_assimp(file).scene); });
}
