// sightline structures: every structure, the same hits, figures that make sense, pictures.
#include "cli/program.hpp"
#include "sightline/index/tracer.hpp"

namespace sightline::cli_test {
namespace {

class Structures : public ProgramTest {};

TEST_F(Structures, ComparesAllOnTheSameRays) {
  const Outcome outcome =
      run({"structures", "generate:city:objects=40", "--rays", "400", "--plot", file("p.svg"), "--json", "-"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json json = outcome.json();
  ASSERT_EQ(json.at("structures").size(), tracer_kinds().size());
  for (const auto& row : json.at("structures")) {
    for (const char* set : {"camera", "random"}) {
      EXPECT_EQ(row.at(set).at("differ"), 0) << row.at("name");
      EXPECT_GT(row.at(set).at("rays_per_s"), 0.0) << row.at("name");
      EXPECT_GE(row.at(set).at("share_in_tests"), 0.0) << row.at("name");
      EXPECT_LE(row.at(set).at("share_in_tests"), 1.0) << row.at("name");
    }
    if (row.at("name") == "brute") {
      EXPECT_EQ(row.at("random").at("tests_per_ray"), json.at("triangles"));
    } else {
      EXPECT_LT(row.at("random").at("tests_per_ray").get<double>(), json.at("triangles").get<double>() / 4);
    }
  }
  const std::string svg = read_file(file("p.svg"));
  for (const TracerKind& kind : tracer_kinds())
    EXPECT_NE(svg.find(">" + std::string(kind.name) + "<"), std::string::npos);
}

TEST_F(Structures, TheKdTreeNeedsFewerCellsThanTheQuadtree) {
  const Outcome outcome =
      run({"structures", "example", "--rays", "100", "--structure", "brute,bvh8", "--cells", file("c.svg")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::string svg = read_file(file("c.svg"));
  EXPECT_NE(svg.find("4 generations"), std::string::npos);
  EXPECT_NE(svg.find("8 generations"), std::string::npos);
  for (const char* label : {">e<", ">r<", ">b<", ">c<"}) EXPECT_NE(svg.find(label), std::string::npos) << label;
  const auto leaves = [&](std::size_t from) {
    const std::size_t end = svg.find(" leaves", from);
    return std::stoi(svg.substr(svg.rfind(' ', end - 1) + 1));
  };
  EXPECT_LT(leaves(svg.find("8 generations")), leaves(svg.find("4 generations")));
}

TEST_F(Structures, TheOctreeFigureHasThreeParts) {  // 14.11
  const Outcome outcome =
      run({"structures", "generate:city:objects=30", "--rays", "10", "--structure", "bvh8", "--octree", file("o.svg")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::string svg = read_file(file("o.svg"));
  const auto nodes = [&](const std::string& part) {
    const std::size_t at = svg.find("(" + part + ") ");
    return at == std::string::npos ? -1 : std::stoi(svg.substr(at + 4));
  };
  EXPECT_EQ(nodes("a"), 1);
  EXPECT_EQ(nodes("b"), 9) << "every inner node has eight children";
  EXPECT_GT(nodes("c"), 9);
  EXPECT_EQ(nodes("c") % 8, 1);
}

TEST_F(Structures, Complains) {
  expect_complaint({"structures", "generate:city:objects=20", "--structure", "bvh9"}, 2, "bvh9");
  expect_complaint({"structures", "generate:city:objects=20", "--rays", "0"}, 2, "--rays");
  expect_complaint({"structures", file("nothing.glb")}, 3, "nothing.glb");
}

}  // namespace
}  // namespace sightline::cli_test
