// What goes wrong with OpenGL is one line, and what comes after it works: a lost context, no memory. Faults are
// injected where epoxy keeps the addresses of OpenGL's functions.
#include "gl/compare.hpp"
#include "gl/registry.hpp"
#include "gl/with_context.hpp"
#include "sightline/scene/generate/generate.hpp"

namespace sightline::gl {
namespace {

/// Puts another function in the place of one of OpenGL's, and takes it back.
template <class Function>
class Injected {
 public:
  Injected(Function& place, Function fault) : place_(place), kept_(place) { place = fault; }
  ~Injected() { place_ = kept_; }
  Injected(const Injected&) = delete;
  Injected& operator=(const Injected&) = delete;

 private:
  Function& place_;
  Function kept_;
};

class Faults : public WithContext {
 protected:
  Faults() : scene_(generate_scene("city", {.objects = 60, .triangles = 0, .seed = 1})) {
    view_.eye = {0.0, 2.0, 0.0};
    view_.width = 64;
    view_.height = 36;
  }

  template <class Action>
  static void expect_line(const Action& action, const std::string& word) {
    try {
      action();
      ADD_FAILURE() << "no complaint about " << word;
    } catch (const Unavailable& error) {
      const std::string line = error.what();
      EXPECT_NE(line.find(word), std::string::npos) << line;
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    }
  }

  Scene scene_;
  View view_;
};

TEST_F(Faults, ALostContextEndsEveryMethodsFrame) {
  SceneDrawing drawing(*context(), scene_);
  Target target;
  for (const GlAlgorithm& algorithm : algorithms()) {
    const auto method = make_method(algorithm.row.name, drawing);
    {
      const Injected lost(epoxy_glGetGraphicsResetStatus, +[]() -> GLenum { return GL_UNKNOWN_CONTEXT_RESET; });
      expect_line([&] { method->frame(view_, target); }, "lost");
    }
    EXPECT_NO_THROW(method->frame(view_, target)) << algorithm.row.name;
  }
}

TEST_F(Faults, NoMemoryInAFrameIsNamed) {
  SceneDrawing drawing(*context(), scene_);
  Target target;
  target.resize(view_.width, view_.height);
  const auto method = make_method("gl_chcpp", drawing);
  {
    const Injected full(epoxy_glGetError, +[]() -> GLenum { return GL_OUT_OF_MEMORY; });
    expect_line([&] { method->frame(view_, target); }, "memory");
  }
  EXPECT_NO_THROW(method->frame(view_, target));
}

TEST_F(Faults, NoMemoryForASceneOrAPictureIsNamed) {
  const Injected full(epoxy_glGetError, +[]() -> GLenum { return GL_OUT_OF_MEMORY; });
  expect_line([&] { SceneDrawing drawing(*context(), scene_); }, "bytes");
  Target target;
  expect_line([&] { target.resize(64, 36); }, "64x36");
}

// A fault of a driver: Mesa takes a count that is left bound for other indirect draws, which then draw nothing.
TEST_F(Faults, BoxesAreDrawnAlthoughPhaseOneDrewNothing) {
  const Scene scene = generate_scene("city", {.objects = 300, .triangles = 0, .seed = 6});
  SceneDrawing drawing(*context(), scene);
  Comparison comparison(drawing);
  View away = look_along({0.0, 500.0, 0.0}, {0.0, 1.0, 0.0}), back = look_along({0.0, 1.7, 0.0}, {1.0, 0.0, 0.0});
  for (View* view : {&away, &back}) {
    view->width = 160;
    view->height = 90;
    view->far = 4000.0;
  }
  for (const char* name : {"gl_hzb", "gl_raster"}) {
    const auto method = make_method(name, drawing);
    for (const View& view : {back, away, away, back}) {  // after `away` nothing is known to be seen
      comparison.draw_all(view);
      EXPECT_EQ(comparison.differing_pixels(*method, view), 0u) << name;
    }
  }
}

}  // namespace
}  // namespace sightline::gl
