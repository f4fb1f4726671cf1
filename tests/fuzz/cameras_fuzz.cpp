// Any bytes as calibrated cameras.
#include "reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace sightline;
  return fuzz::expect_one_line([&] {
    for (const CalibratedCamera& camera : parse_cameras("fuzz.json", fuzz::bytes_of(data, size))) check_camera(camera);
  });
}
