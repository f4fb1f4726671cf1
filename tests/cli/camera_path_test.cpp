// --path camera: the cameras of a scene file as the path of a walk.
#include "cli/program.hpp"

namespace sightline::cli_test {
namespace {

using Json = nlohmann::json;

class CameraPath : public ProgramTest {
 protected:
  /// A triangle, a standing camera "door" and "cart", which an animation moves from x = 0 to 10; as JSON with data
  /// inside.
  std::string scene() const {
    const std::string name = file("cameras.gltf");
    std::ofstream(name) << R"({"asset":{"version":"2.0"},
"buffers":[{"byteLength":68,"uri":"data:application/octet-stream;base64,)"
                           // three positions; times 0 and 2; translations (0,0,5) and (10,0,5)
                           "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"
                           "AAAAAAAAAEAAAAAAAAAAAAAAoEAAACBBAAAAAAAAoEA="
                        << R"("}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":8},{"buffer":0,"byteOffset":44,"byteLength":24}],
"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":3},
{"bufferView":1,"componentType":5126,"type":"SCALAR","count":2},{"bufferView":2,"componentType":5126,"type":"VEC3","count":2}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"cameras":[{"type":"perspective","perspective":{"yfov":0.5,"znear":0.1}}],
"nodes":[{"mesh":0},{"name":"door","camera":0,"translation":[1,2,3]},{"name":"cart","camera":0,"translation":[0,0,5]}],
"animations":[{"samplers":[{"input":1,"output":2}],"channels":[{"sampler":0,"target":{"node":2,"path":"translation"}}]}]})";
    return name;
  }
  Json walk(const std::string& path) const {
    const Outcome outcome =
        run({"walk", scene(), "--path", path, "--frames", "3", "--size", "64x36", "--json", "-", "--quiet"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.json();
  }
};

TEST_F(CameraPath, TheMovingOneFirst) {
  for (const char* path : {"camera", "camera:cart"}) {
    const Json frames = walk(path).at("frames");
    ASSERT_EQ(frames.size(), 3u);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(frames[i].at("eye"), Json({5.0 * i, 0.0, 5.0})) << path;
  }
}

TEST_F(CameraPath, AStandingOneByItsName) {
  const Json frames = walk("camera:door").at("frames");
  for (int i = 0; i < 3; ++i) EXPECT_EQ(frames[i].at("eye"), Json({1.0, 2.0, 3.0}));
}

TEST_F(CameraPath, UnknownNamesAreRefused) {
  expect_complaint({"walk", scene(), "--path", "camera:window"}, 2, "door, cart");
  expect_complaint({"walk", "generate:city:objects=50", "--path", "camera"}, 2, "no camera");
}

}  // namespace
}  // namespace sightline::cli_test
