// Any bytes as a Wavefront OBJ file; material files beside it do not exist.
#include "reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace sightline;
  return fuzz::expect_one_line(
      [&] { fuzz::expect_sound(read_obj("/nonexistent/fuzz.obj", fuzz::bytes_of(data, size)).scene); });
}
