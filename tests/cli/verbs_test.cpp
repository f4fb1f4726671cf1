// The other verbs: info, list, generate, render.
#include "cli/program.hpp"
#include "methods.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/generate/generate.hpp"

namespace sightline::cli_test {
namespace {

using Json = nlohmann::json;

class Verbs : public ProgramTest {};

TEST_F(Verbs, ListIsTheRegistry) {
  const Json json = run({"list", "--json", "-"}).json();
  ASSERT_EQ(json.at("algorithms").size(), cli::all_algorithms().size());
  for (std::size_t i = 0; i < cli::all_algorithms().size(); ++i) {
    const Json& row = json.at("algorithms")[i];
    EXPECT_EQ(row.at("name"), cli::all_algorithms()[i].name);
    EXPECT_EQ(row.at("promise"), to_string(cli::all_algorithms()[i].promise));
    for (const char* key : {"family", "paper", "checklist", "summary"}) EXPECT_TRUE(row.at(key).is_string());
  }
  EXPECT_EQ(json.at("generators").size(), generators().size());
  const Outcome text = run({"list"}), markdown = run({"list", "--markdown"});
  for (const Algorithm& row : cli::all_algorithms()) {
    EXPECT_NE(text.out.find(row.name), std::string::npos);
    EXPECT_NE(markdown.out.find("| [`" + std::string(row.name) + "`](docs/algorithms/"), std::string::npos);
  }
}

TEST_F(Verbs, GeneratedFileHoldsTheGeneratedScene) {
  const Outcome outcome =
      run({"generate", "city", "--objects", "60", "--seed", "3", "-o", file("city.glb"), "--json", "-"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json written = outcome.json();
  const Json direct = run({"info", "generate:city:objects=60:seed=3", "--json", "-"}).json();
  const Json loaded = run({"info", file("city.glb"), "--json", "-"}).json();
  EXPECT_EQ(written.at("objects"), direct.at("objects"));
  for (const char* key : {"objects", "triangles", "unique_meshes", "closed_meshes"})
    EXPECT_EQ(loaded.at(key), direct.at(key)) << key;
  for (const char* end : {"lo", "hi"})
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(loaded.at("bounds").at(end)[axis].get<double>(), direct.at("bounds").at(end)[axis].get<double>(),
                  1e-2);
  for (const char* key : {"cells", "portals"}) EXPECT_TRUE(loaded.at(key).is_number()) << key;
  for (const char* key : {"cameras", "warnings"}) EXPECT_TRUE(loaded.at(key).is_array()) << key;
  EXPECT_GT(loaded.at("load_ms"), 0.0);
}

/// Two independent ways to the same view must agree on what is seen, up to the pixels of edges.
TEST_F(Verbs, RenderersDrawTheSameView) {
  std::vector<Json> results;
  for (const char* method : {"zbuffer", "oracle"}) {
    const Outcome outcome = run({"render", "generate:city:objects=100", "--method", method, "--frame", "2", "--frames",
                                 "4", "--size", "120x80", "--show", "object", "-o", file("x.png"), "--json", "-"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(read_file(file("x.png")).substr(1, 3), "PNG");
    results.push_back(outcome.json());
  }
  EXPECT_GT(results[0].at("pixels_covered"), 0);
  EXPECT_NEAR(results[0].at("pixels_covered").get<double>(), results[1].at("pixels_covered").get<double>(), 96.0);
  EXPECT_EQ(results[0].at("eye"), results[1].at("eye"));
}

TEST_F(Verbs, RenderTakesAnEye) {
  for (const char* show : {"depth", "object", "normal", "shaded"}) {
    const Outcome outcome =
        run({"render", "generate:city:objects=100", "--eye", "-5,60,-8", "--look", "0.1,-1,.1", "--show", show,
             "--size", "64x48", "-o", file(std::string(show) + ".png"), "--json", "-"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.json().at("eye"), Json({-5.0, 60.0, -8.0}));
  }
  EXPECT_NE(read_file(file("depth.png")), read_file(file("object.png")));
  EXPECT_NE(read_file(file("normal.png")), read_file(file("shaded.png")));
}

}  // namespace
}  // namespace sightline::cli_test
