// Any bytes as a camera path; the first byte chooses between text and JSON.
#include "reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace sightline;
  if (size == 0) return 0;
  return fuzz::expect_one_line([&] {
    const char* file = data[0] == 'j' ? "fuzz.json" : "fuzz.txt";
    PathConfig config;
    config.frames = 20;
    const CameraPath path = parse_path(file, fuzz::bytes_of(data + 1, size - 1), config);
    for (const View& view : path.views) check_view(view);
  });
}
