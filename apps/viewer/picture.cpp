#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "gl/presentation.hpp"
#include "sightline/scene/input_error.hpp"
#include "viewer/panel.hpp"
#include "viewer/viewer.hpp"

namespace sightline::viewer {
namespace {

/// Dear ImGui without a window.
class Widgets {
 public:
  Widgets(int width, int height) {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui::GetIO().DisplaySize = ImVec2(static_cast<float>(width), static_cast<float>(height));
    ImGui::GetIO().DeltaTime = 1.0f / 60.0f;
    ImGui_ImplOpenGL3_Init("#version 450 core");
  }
  ~Widgets() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext();
  }
  Widgets(const Widgets&) = delete;
  Widgets& operator=(const Widgets&) = delete;

  static void draw(Session& session) {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui::NewFrame();
    show_panel(session);
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  }
};

}  // namespace

std::vector<std::uint8_t> picture_of(SessionConfig config, const IndexedScene& scene, const PictureConfig& picture) {
  gl::Context context;
  Session session(std::move(config), scene, context);
  gl::Presentation presentation(context);
  const gl::Canvas canvas(picture.width, picture.height);
  const Widgets widgets(picture.width, picture.height);
  const auto frame = [&] { session.draw(picture.width, picture.height, 1.0 / 60.0); };
  for (int i = 0; i < picture.settle_frames; ++i) frame();
  for (const char key : picture.press) {
    if (!session.press(key)) throw InputError(std::string("no key '") + key + "' of the viewer changes a picture");
    frame();
  }
  if (picture.click_x >= 0) session.choose(picture.click_x, picture.click_y);
  frame();
  // Windows know their size only after they were drawn once.
  for (int i = 0; i < 2; ++i) {
    if (session.shows_depth())
      presentation.show_depth(session.target(), session.view(), canvas.framebuffer());
    else
      presentation.show_colour(session.target(), canvas.framebuffer());
    Widgets::draw(session);
  }
  return gl::read_rgb(canvas.framebuffer(), picture.width, picture.height);
}

}  // namespace sightline::viewer
