// What the viewer shows and how keys change it: scene, camera, method, colours, frozen culling. Draws into a target;
// knows no window and no widgets, so that tests and pictures without a display run the same code.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gl/line_drawing.hpp"
#include "gl/method.hpp"
#include "gl/scene_drawing.hpp"
#include "sightline/core/algorithm.hpp"
#include "viewer/navigation.hpp"
#include "viewer/standing.hpp"

namespace sightline::viewer {

struct SessionConfig {
  std::string scene_argument;        // as typed, for the command line that shows the same view
  std::vector<std::string> methods;  // the first is active; M goes through them
  View start;                        // where the eye is first
  std::vector<View> path;            // N and P go through them, the space bar plays them; may be empty
  std::size_t path_frame = 0;        // index into path of `start`
  /// Says in a few lines why an object is seen or not from a view, beside what the method said; empty: no answers.
  std::function<std::string(const View&, ObjectId, const std::string& method, bool reported)> explain;
};

/// What one frame was.
struct FrameFigures {
  std::array<std::size_t, 4> objects{};  // by Standing
  std::uint64_t triangles = 0, scene_triangles = 0;
  double cull_ms = 0.0, draw_ms = 0.0;  // wall clock; for methods of OpenGL all counts as drawing
  std::uint64_t queries = 0, state_changes = 0, waits = 0, draw_calls = 0;
};

class Session {
 public:
  /// `scene` and `context` must outlive it. Throws InputError for a method that does not exist, Unavailable.
  Session(SessionConfig config, const IndexedScene& scene, gl::Context& context);
  ~Session();

  /// One key as on the window: F O C V B Z Q M N P, space, ?. False if it means nothing.
  bool press(char key);
  /// The lines that ? shows, "key", "what it does".
  static std::vector<std::pair<std::string, std::string>> keys();

  /// Culls (unless frozen) and draws a frame of width x height pixels.
  void draw(int width, int height, double seconds_since_last);
  [[nodiscard]] const gl::Target& target() const { return target_; }
  /// The camera of the last frame.
  [[nodiscard]] const View& view() const { return view_; }
  [[nodiscard]] bool shows_depth() const { return depth_; }

  /// The object at a pixel of the last frame (row 0 on top) becomes the chosen one and is explained; none clears.
  void choose(int x, int y);
  [[nodiscard]] ObjectId chosen() const { return chosen_; }
  [[nodiscard]] const std::string& explanation() const { return explanation_; }

  [[nodiscard]] Navigation& navigation() { return navigation_; }
  [[nodiscard]] const FrameFigures& figures() const { return figures_; }
  /// Milliseconds of the last frames, oldest first.
  [[nodiscard]] const std::vector<float>& history() const { return history_; }
  [[nodiscard]] const std::string& method() const { return config_.methods[method_index_]; }
  [[nodiscard]] const std::vector<std::string>& methods() const { return config_.methods; }
  void set_method(std::size_t index);
  [[nodiscard]] bool frozen() const { return frozen_view_.has_value(); }
  [[nodiscard]] bool playing() const { return playing_; }
  [[nodiscard]] bool help() const { return help_; }
  [[nodiscard]] bool colours_by_standing() const { return by_standing_; }
  [[nodiscard]] bool shows_bounds() const { return bounds_; }
  [[nodiscard]] bool shows_queries() const { return by_query_; }
  [[nodiscard]] bool quit() const { return quit_; }
  /// The line of a shell that opens the viewer at this view.
  [[nodiscard]] std::string command_line() const;

 private:
  void make_method();
  void cull(const View& view);
  void cull_on_processor(const View& view);
  void cull_through_gl(const View& view);
  void judge(const View& view);
  void colour();
  void draw_lines();
  void read_queries();
  void step_path(int by);

  SessionConfig config_;
  const IndexedScene& scene_;
  gl::SceneDrawing drawing_;
  gl::LineDrawing line_drawing_;
  gl::Target target_;
  Navigation navigation_;
  VisibleSet all_, frustum_, large_, visible_;
  std::unique_ptr<Culler> frustum_culler_, detail_culler_, culler_;
  std::unique_ptr<gl::Method> gl_method_;
  std::string query_log_;
  std::vector<std::vector<std::uint32_t>> queries_;  // of the last frame: the nodes that each asked about
  std::vector<Standing> standings_;
  View view_;
  std::optional<View> frozen_view_;
  std::size_t method_index_ = 0;
  bool by_standing_ = false, bounds_ = false, depth_ = false, by_query_ = false, help_ = false, playing_ = false,
       quit_ = false, recoloured_ = false;
  double played_ = 0.0;
  ObjectId chosen_ = no_object;
  std::string explanation_;
  FrameFigures figures_;
  std::vector<float> history_;
};

}  // namespace sightline::viewer
