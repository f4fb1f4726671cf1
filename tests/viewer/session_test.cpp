// What the viewer draws and what its keys do, without a window. Skipped where there is no OpenGL.
#include "viewer/session.hpp"

#include <gtest/gtest.h>

#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/input_error.hpp"
#include "viewer/viewer.hpp"

namespace sightline::viewer {
namespace {

class ViewerSession : public testing::Test {
 protected:
  void SetUp() override {
    try {
      context_.emplace();
    } catch (const gl::Unavailable& error) {
      GTEST_SKIP() << "NO OPENGL: " << error.what();
    }
    scene_ = generate_scene("city", {.objects = 400, .triangles = 0, .seed = 2});
    indexed_.emplace(index_scene(scene_));
  }

  [[nodiscard]] SessionConfig config(std::vector<std::string> methods = {"occlusion_masked", "none"}) const {
    SessionConfig config;
    config.scene_argument = "generate:city:objects=400:seed=2";
    config.methods = std::move(methods);
    View view = look_along(glm::dvec3(scene_.bounds().centre()) + glm::dvec3(0, 1, 0), {1, 0, 0.3});
    config.start = view;
    for (int i = 0; i < 5; ++i) {
      view.eye.y += 1;
      config.path.push_back(view);
    }
    return config;
  }

  std::vector<std::uint32_t> ids_of(Session& session) const {
    std::vector<std::uint32_t> ids;
    session.draw(320, 200, 0.0);
    session.target().read_ids(ids);
    return ids;
  }

  std::optional<gl::Context> context_;
  Scene scene_ = SceneBuilder().build();
  std::optional<IndexedScene> indexed_;
};

TEST_F(ViewerSession, EveryMethodShowsTheSamePicture) {
  Session session(config({"none", "frustum_linear", "occlusion_masked", "gl_frustum", "gl_chc", "gl_chcpp"}), *indexed_,
                  *context_);
  const std::vector<std::uint32_t> all = ids_of(session);
  std::size_t covered = 0;
  for (const std::uint32_t id : all) covered += id != no_object ? 1 : 0;
  EXPECT_GT(covered, all.size() / 4);
  for (std::size_t i = 1; i < session.methods().size(); ++i) {
    session.set_method(i);
    for (int frame = 0; frame < 3; ++frame) {
      const std::vector<std::uint32_t> ids = ids_of(session);
      std::size_t different = 0;
      for (std::size_t p = 0; p < ids.size(); ++p) different += ids[p] != all[p] ? 1 : 0;
      EXPECT_EQ(different, 0u) << session.method();
    }
  }
}

TEST_F(ViewerSession, FrozenCullingStaysWhileTheCameraMoves) {
  Session session(config(), *indexed_, *context_);
  session.draw(320, 200, 0.0);
  const auto before = session.figures().objects;
  EXPECT_GT(before[static_cast<std::size_t>(Standing::outside)], 0u);
  session.press('C');
  session.navigation().orbit(500, 100);
  session.draw(320, 200, 0.0);
  EXPECT_TRUE(session.frozen());
  EXPECT_EQ(session.figures().objects, before);
  session.press('C');
  session.draw(320, 200, 0.0);
  EXPECT_FALSE(session.frozen());
  EXPECT_NE(session.figures().objects, before);
}

TEST_F(ViewerSession, KeysDoWhatTheListSays) {
  Session session(config(), *indexed_, *context_);
  session.draw(320, 200, 0.0);
  session.press('M');
  EXPECT_EQ(session.method(), "none");
  session.press('M');
  EXPECT_EQ(session.method(), "occlusion_masked");
  session.press('V');
  EXPECT_TRUE(session.colours_by_standing());
  session.press('Z');
  EXPECT_TRUE(session.shows_depth());
  session.press('B');
  EXPECT_TRUE(session.shows_bounds());
  session.press('?');
  EXPECT_TRUE(session.help());
  const View before = session.view();
  session.press('N');
  session.draw(320, 200, 0.0);
  EXPECT_NE(session.view().eye, before.eye);
  session.press(' ');
  EXPECT_TRUE(session.playing());
  session.press('F');
  session.draw(320, 200, 0.1);
  EXPECT_FALSE(session.press('5'));
  session.press('\x1b');
  EXPECT_TRUE(session.quit());
}

TEST_F(ViewerSession, AClickChoosesWhatThePixelShows) {
  SessionConfig with_answers = config();
  ObjectId asked = no_object;
  with_answers.explain = [&](const View&, ObjectId id, const std::string&, bool reported) {
    asked = id;
    return std::string(reported ? "reported" : "not reported");
  };
  Session session(with_answers, *indexed_, *context_);
  const std::vector<std::uint32_t> ids = ids_of(session);
  session.choose(160, 150);
  EXPECT_EQ(session.chosen(), ids[(200 - 1 - 150) * 320 + 160]);
  ASSERT_NE(session.chosen(), no_object);
  EXPECT_EQ(asked, session.chosen());
  EXPECT_NE(session.explanation().find("reported"), std::string::npos);
  session.choose(-1, 5);
  EXPECT_EQ(session.chosen(), no_object);
}

TEST_F(ViewerSession, QueriesGiveTheirObjectsAColour) {
  Session session(config({"gl_chc"}), *indexed_, *context_);
  Frame plain, coloured;
  session.draw(320, 200, 0.0);
  session.target().read_back(session.view(), plain);
  session.press('Q');
  for (int i = 0; i < 3; ++i) session.draw(320, 200, 0.0);
  session.target().read_back(session.view(), coloured);
  EXPECT_GT(session.figures().queries, 0u);
  EXPECT_EQ(plain.object, coloured.object);
  EXPECT_NE(plain.colour, coloured.colour);
}

TEST_F(ViewerSession, PicturesNeedNoWindowAndShowWhatWasPressed) {
  PictureConfig picture;
  picture.width = 400;
  picture.height = 240;
  const auto plain = picture_of(config(), *indexed_, picture);
  ASSERT_EQ(plain.size(), 400u * 240u * 3u);
  EXPECT_EQ(plain.size(), picture_of(config(), *indexed_, picture).size());
  picture.press = "CVO";
  EXPECT_NE(picture_of(config(), *indexed_, picture), plain);
  picture.press = "Z";
  EXPECT_NE(picture_of(config(), *indexed_, picture), plain);
}

TEST_F(ViewerSession, UnknownMethodsAreErrors) {
  EXPECT_THROW(Session(config({"no_such_method"}), *indexed_, *context_), InputError);
  EXPECT_THROW(Session(config({"gl_chcpp:no_such_key=1"}), *indexed_, *context_), InputError);
}

TEST_F(ViewerSession, AnEmptySceneIsAnEmptyPicture) {
  const Scene empty = SceneBuilder().build();
  const IndexedScene indexed = index_scene(empty);
  SessionConfig nothing;
  nothing.methods = {"occlusion_masked", "gl_chcpp"};
  Session session(nothing, indexed, *context_);
  for (const char key : std::string("FOCVBZQM")) {
    session.press(key);
    session.draw(64, 48, 0.1);
  }
  session.choose(3, 3);
  EXPECT_EQ(session.chosen(), no_object);
}

}  // namespace
}  // namespace sightline::viewer
