// Any bytes as a glTF file, JSON or binary; buffers beside the file do not exist.
#include "reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace sightline;
  return fuzz::expect_one_line(
      [&] { fuzz::expect_sound(read_gltf("/nonexistent/fuzz.gltf", fuzz::bytes_of(data, size)).scene); });
}
