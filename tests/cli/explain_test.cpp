// sightline explain: what it prints is what the walk and the truth say.
#include <algorithm>
#include <set>

#include "cli/program.hpp"

namespace sightline::cli_test {
namespace {

using Json = nlohmann::json;

class Explain : public ProgramTest {
 protected:
  const std::vector<std::string> view_{
      "generate:city:objects=300", "--frame", "2", "--frames", "4", "--size", "160x90"};
  Outcome explain(std::vector<std::string> more) const {
    std::vector<std::string> words{"explain"};
    words.insert(words.end(), view_.begin(), view_.end());
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
};

TEST_F(Explain, AgreesWithTheWalk) {
  const Json walk =
      run({"walk", "generate:city:objects=300", "--frames", "4", "--size", "160x90", "--ids", "--json", "-", "--quiet"})
          .json();
  const Json& frame = walk.at("frames")[2];
  const std::vector<int> visible = frame.at("visible_ids");
  std::set<std::string> fates;
  for (int id = 0; id < 300; id += 17) {
    const Outcome outcome = explain({"--object", std::to_string(id), "--json", "-"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Json json = outcome.json();
    EXPECT_EQ(json.at("reported"), std::find(visible.begin(), visible.end(), id) != visible.end()) << id;
    EXPECT_EQ(json.at("verified"), true);
    EXPECT_EQ(json.at("fate") == "seen", json.at("witness").is_object());
    EXPECT_TRUE(json.at("fate") != "seen" || json.at("reported")) << id;
    fates.insert(json.at("fate"));
  }
  EXPECT_TRUE(fates.contains("seen") && fates.contains("occluded") && fates.contains("outside"));
}

TEST_F(Explain, TellsAPersonAndDraws) {
  const Outcome outcome = explain({"--object", "0", "-o", file("why.png")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("object 0"), std::string::npos);
  EXPECT_NE(outcome.out.find("verified by rays"), std::string::npos);
  EXPECT_EQ(read_file(file("why.png")).substr(1, 3), "PNG");
}

TEST_F(Explain, NothingIsMissedByNone) {
  const Outcome outcome = explain({"--object", "0", "--method", "none", "--json", "-"});
  EXPECT_EQ(outcome.json().at("reported"), true);
  EXPECT_EQ(outcome.json().at("missed"), false);
}

TEST_F(Explain, ManyRandomPairsAreAllVerified) {
  const Outcome outcome = run({"explain", "generate:building:objects=300", "--random", "200", "--frames", "20",
                               "--size", "160x90", "--json", "-", "--quiet"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json json = outcome.json();
  EXPECT_EQ(json.at("pairs"), 200);
  EXPECT_EQ(json.at("not_confirmed"), 0);
  EXPECT_EQ(json.at("missed"), 0);
  EXPECT_GT(json.at("fates").at("seen"), 20);
  EXPECT_GT(json.at("fates").at("occluded"), 20);
}

}  // namespace
}  // namespace sightline::cli_test
