#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <string>

#include "gl/presentation.hpp"
#include "viewer/glfw_window.hpp"
#include "viewer/panel.hpp"
#include "viewer/viewer.hpp"

namespace sightline::viewer {
namespace {

/// The widgets of a window; made after its callbacks are set, as they pass on what they do not want.
class Widgets {
 public:
  explicit Widgets(GLFWwindow* window) {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 450 core");
  }
  ~Widgets() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  Widgets(const Widgets&) = delete;
  Widgets& operator=(const Widgets&) = delete;
};

/// What the mouse and keys say, until the next frame takes it.
struct Input {
  Session* session = nullptr;
  double x = 0.0, y = 0.0, pressed_x = 0.0, pressed_y = 0.0;
};

bool widgets_want_mouse() { return ImGui::GetCurrentContext() != nullptr && ImGui::GetIO().WantCaptureMouse; }

Input& input_of(GLFWwindow* window) { return *static_cast<Input*>(glfwGetWindowUserPointer(window)); }

void on_character(GLFWwindow* window, unsigned code) {
  if (ImGui::GetIO().WantTextInput || code > 127) return;
  const char key = static_cast<char>(std::toupper(static_cast<int>(code)));
  if (key == 'W' || key == 'A' || key == 'S' || key == 'D' || key == 'E' || key == 'X') return;  // held: see motion()
  input_of(window).session->press(key);
}

void on_key(GLFWwindow* window, int key, int /*scancode*/, int action, int /*modifiers*/) {
  if (key == GLFW_KEY_ESCAPE && action == GLFW_PRESS) input_of(window).session->press('\x1b');
}

void on_move(GLFWwindow* window, double x, double y) {
  Input& input = input_of(window);
  const double dx = x - input.x, dy = y - input.y;
  input.x = x;
  input.y = y;
  if (widgets_want_mouse()) return;
  if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS) input.session->navigation().orbit(dx, dy);
  if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS) input.session->navigation().turn(dx, dy);
}

void on_button(GLFWwindow* window, int button, int action, int /*modifiers*/) {
  Input& input = input_of(window);
  if (button != GLFW_MOUSE_BUTTON_LEFT || widgets_want_mouse()) return;
  if (action == GLFW_PRESS) {
    input.pressed_x = input.x;
    input.pressed_y = input.y;
  } else if (std::abs(input.x - input.pressed_x) + std::abs(input.y - input.pressed_y) < 3.0) {
    input.session->choose(static_cast<int>(input.x), static_cast<int>(input.y));
  }
}

void on_wheel(GLFWwindow* window, double /*dx*/, double dy) {
  if (!widgets_want_mouse()) input_of(window).session->navigation().dolly(dy);
}

Motion motion(GLFWwindow* window) {
  if (ImGui::GetIO().WantTextInput) return {};
  const auto held = [window](int key) { return glfwGetKey(window, key) == GLFW_PRESS; };
  return {held(GLFW_KEY_W),
          held(GLFW_KEY_S),
          held(GLFW_KEY_A),
          held(GLFW_KEY_D),
          held(GLFW_KEY_E),
          held(GLFW_KEY_X),
          held(GLFW_KEY_LEFT_SHIFT) || held(GLFW_KEY_RIGHT_SHIFT)};
}

}  // namespace

void run_window(SessionConfig config, const IndexedScene& scene, int width, int height) {
  const GlfwWindow window(width, height, "sightline " + config.scene_argument);
  gl::Context context = gl::Context::of_current();
  Session session(std::move(config), scene, context);
  gl::Presentation presentation(context);
  Input input{&session};
  glfwSetWindowUserPointer(window.get(), &input);
  glfwSetCharCallback(window.get(), on_character);
  glfwSetKeyCallback(window.get(), on_key);
  glfwSetCursorPosCallback(window.get(), on_move);
  glfwSetMouseButtonCallback(window.get(), on_button);
  glfwSetScrollCallback(window.get(), on_wheel);
  const Widgets widgets(window.get());
  double last = glfwGetTime();
  while (glfwWindowShouldClose(window.get()) == GLFW_FALSE && !session.quit()) {
    glfwPollEvents();
    const double now = glfwGetTime(), seconds = now - last;
    last = now;
    int w = 0, h = 0;
    glfwGetFramebufferSize(window.get(), &w, &h);
    if (w == 0 || h == 0) {  // minimised
      glfwWaitEventsTimeout(0.1);
      continue;
    }
    session.navigation().fly(motion(window.get()), std::min(seconds, 0.1));
    session.draw(w, h, seconds);
    if (session.shows_depth())
      presentation.show_depth(session.target(), session.view(), 0);
    else
      presentation.show_colour(session.target(), 0);
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    show_panel(session);
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    glfwSwapBuffers(window.get());
  }
}

}  // namespace sightline::viewer
