// sightline maze: a maze drawn by the column caster, as a picture, in a window, or in colour blocks of the terminal.
#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>

#include "json_output.hpp"
#include "methods.hpp"
#include "picture.hpp"
#include "query_options.hpp"
#include "scene_argument.hpp"
#include "sightline/surface/column_cast.hpp"

#ifdef SIGHTLINE_VIEWER
#include "gl/context.hpp"
#include "viewer/picture_window.hpp"
#endif

namespace sightline::cli {
namespace {

/// Where the walker stands and looks: angle in radians, 0 along +x, growing towards +z.
struct Walker {
  double x = 1.5, z = 1.5, angle = 0.0;
};

View view_of(const Walker& walker, int width, int height, double fov) {
  View view = look_along({walker.x, 0.5, walker.z}, {std::cos(walker.angle), 0.0, std::sin(walker.angle)});
  view.width = width;
  view.height = height;
  view.fov_y = glm::radians(fov);
  view.near = 1e-3;
  view.far = 2000.0;
  return view;
}

/// Along the longest free way from the first cell.
Walker at_the_start(const GridMap& map, const MazeOptions& options) {
  Walker walker{options.start_x + 0.5, options.start_z + 0.5, glm::radians(options.look)};
  if (options.look_given) return walker;
  int longest = -1;
  for (int quarter = 0; quarter < 4; ++quarter) {
    constexpr glm::ivec2 ways[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    int free = 0;
    while (map.at(options.start_x + (free + 1) * ways[quarter].x, options.start_z + (free + 1) * ways[quarter].y) ==
               0 &&
           free < 1000)
      ++free;
    if (free <= longest) continue;
    longest = free;
    walker.angle = glm::radians(90.0 * quarter);
  }
  return walker;
}

/// Keeps a little distance to walls, along each axis by itself, so that one slides along them.
void step(Walker& walker, const GridMap& map, double forward, double right) {
  const double dx = forward * std::cos(walker.angle) - right * std::sin(walker.angle);
  const double dz = forward * std::sin(walker.angle) + right * std::cos(walker.angle);
  const auto free = [&](double x, double z) {
    constexpr double body = 0.2;
    for (const double ox : {-body, body})
      for (const double oz : {-body, body})
        if (map.at(static_cast<int>(std::floor(x + ox)), static_cast<int>(std::floor(z + oz))) != 0) return false;
    return true;
  };
  if (free(walker.x + dx, walker.z)) walker.x += dx;
  if (free(walker.x, walker.z + dz)) walker.z += dz;
}

/// Keys one by one, without echo, until destroyed.
class RawTerminal {
 public:
  RawTerminal() {
    tcgetattr(STDIN_FILENO, &saved_);
    termios raw = saved_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    tcsetattr(STDIN_FILENO, TCSANOW, &raw);
    fmt::print("\x1b[?1049h\x1b[?25l\x1b[2J");
  }
  ~RawTerminal() {
    fmt::print("\x1b[0m\x1b[?25h\x1b[?1049l");
    std::fflush(stdout);
    tcsetattr(STDIN_FILENO, TCSANOW, &saved_);
  }
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

 private:
  termios saved_{};
};

/// The next key: a letter, 'A' to 'D' for the arrows, 'q' at the end of the input; waits for it.
char next_key() {
  char bytes[3] = {};
  if (read(STDIN_FILENO, bytes, 1) != 1) return 'q';
  if (bytes[0] != '\x1b') return bytes[0];
  pollfd more{STDIN_FILENO, POLLIN, 0};
  if (poll(&more, 1, 20) <= 0 || read(STDIN_FILENO, bytes + 1, 2) != 2) return 'q';
  return bytes[2];
}

/// Two pixels a character: the upper half block in the upper colour on the lower one.
std::string blocks(const Frame& frame) {
  std::string text = "\x1b[H";
  for (int y = 0; y + 1 < frame.height; y += 2) {
    for (int x = 0; x < frame.width; ++x) {
      const std::uint32_t up = frame.colour[frame.index(x, y)], low = frame.colour[frame.index(x, y + 1)];
      text += fmt::format("\x1b[38;2;{};{};{};48;2;{};{};{}m\u2580", up & 255u, (up >> 8) & 255u, (up >> 16) & 255u,
                          low & 255u, (low >> 8) & 255u, (low >> 16) & 255u);
    }
    text += "\x1b[0m\r\n";
  }
  return text;
}

#ifdef SIGHTLINE_VIEWER
bool there_is_a_display() { return std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr; }

int play_in_a_window(const MazeOptions& options, const GridMap& map) {
  Walker walker = at_the_start(map, options);
  ColumnCastConfig config;
  config.correct_fisheye = !options.fisheye;
  try {
    viewer::run_picture_window("sightline maze: w a s d or arrows, q ends", options.width, options.height,
                               [&](double seconds, const viewer::HeldKeys& keys, int width, int height, Frame& frame) {
                                 constexpr double metres = 2.0, radians = 1.8;  // per second
                                 const auto way = [](bool one, bool other) {
                                   return (one ? 1.0 : 0.0) - (other ? 1.0 : 0.0);
                                 };
                                 walker.angle += seconds * radians * way(keys.turn_right, keys.turn_left);
                                 step(walker, map, seconds * metres * way(keys.forward, keys.back),
                                      seconds * metres * way(keys.right, keys.left));
                                 Counters counters;
                                 column_cast(map, view_of(walker, width, height, options.fov), config, frame, counters);
                               });
  } catch (const gl::Unavailable& error) {
    throw MethodUnavailable(error.what());
  }
  if (!options.common.quiet) fmt::print("stopped at {:.2f} {:.2f}\n", walker.x, walker.z);
  return exit_ok;
}
#endif

int play_in_the_terminal(const MazeOptions& options, const GridMap& map) {
  if (isatty(STDIN_FILENO) == 0 || isatty(STDOUT_FILENO) == 0)
    throw UsageError("--play: needs a display or a terminal; -o FILE writes a picture");
  const RawTerminal terminal;
  Walker walker = at_the_start(map, options);
  ColumnCastConfig config;
  config.correct_fisheye = !options.fisheye;
  while (true) {
    winsize size{};
    ioctl(STDOUT_FILENO, TIOCGWINSZ, &size);
    const int columns = size.ws_col > 0 ? size.ws_col : 80, rows = size.ws_row > 1 ? size.ws_row - 1 : 23;
    Frame frame;
    Counters counters;
    column_cast(map, view_of(walker, columns, 2 * rows, options.fov), config, frame, counters);
    fmt::print("{}w/s forward, back   a/d turn   ,/. aside   q ends", blocks(frame));
    std::fflush(stdout);
    switch (next_key()) {
      case 'w':
      case 'A':
        step(walker, map, 0.15, 0);
        break;
      case 's':
      case 'B':
        step(walker, map, -0.15, 0);
        break;
      case 'a':
      case 'D':
        walker.angle -= 0.1;
        break;
      case 'd':
      case 'C':
        walker.angle += 0.1;
        break;
      case ',':
        step(walker, map, 0, -0.15);
        break;
      case '.':
        step(walker, map, 0, 0.15);
        break;
      case 'q':
        return exit_ok;
      default:
        break;
    }
  }
}

Picture picture_of(const Frame& frame) {
  Picture picture{frame.width, frame.height, {}};
  for (const std::uint32_t c : frame.colour)
    for (int shift = 0; shift < 24; shift += 8) picture.rgb.push_back(static_cast<std::uint8_t>((c >> shift) & 255u));
  return picture;
}

}  // namespace

int run_maze(const MazeOptions& options) {
  const GridMap map = make_maze(options.cells_x, options.cells_z, options.common.seed, 0.12);
  if (options.play) {
#ifdef SIGHTLINE_VIEWER
    if (there_is_a_display()) return play_in_a_window(options, map);
#endif
    return play_in_the_terminal(options, map);
  }
  if (options.output.empty()) throw UsageError("-o FILE or --play is needed");
  OutputFile file(options.output);
  JsonOutput output(options.common);
  const View view = view_of(at_the_start(map, options), options.width, options.height, options.fov);
  as_usage([&] { check_view(view); });
  ColumnCastConfig config;
  config.correct_fisheye = !options.fisheye;
  Frame frame;
  Counters counters;
  const auto start = std::chrono::steady_clock::now();
  column_cast(map, view, config, frame, counters);
  const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  file.write(encode_png(picture_of(frame)));
  file.commit();
  if (options.common.prints())
    fmt::print("{}: {} rays, {} cells walked, {:.2f} ms\n", options.output, view.width, counters.nodes_visited, ms);
  output.write({{"schema", "sightline.maze/1"},
                {"output", options.output},
                {"cells", {map.width, map.depth}},
                {"size", {view.width, view.height}},
                {"eye", {view.eye.x, view.eye.y, view.eye.z}},
                {"rays", view.width},
                {"cells_walked", counters.nodes_visited},
                {"ms", ms}});
  return exit_ok;
}

}  // namespace sightline::cli
