#include "output.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "sightline/scene/input_error.hpp"

namespace sightline::cli {
namespace {
ProgressKind progress_kind = ProgressKind::automatic;
}  // namespace

void occupy_closed_streams() {
  // Read only: what is written to the stream fails as it would if it were closed.
  while (true) {
    const int descriptor = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (descriptor > STDERR_FILENO) close(descriptor);
    if (descriptor < 0 || descriptor > STDERR_FILENO) return;
  }
}

void flush_stdout() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    throw InputError("standard output", "", fmt::format("cannot write: {}", std::strerror(errno)));
}

bool stdout_has_colour() {
  const char* no_color = std::getenv("NO_COLOR");
  return isatty(STDOUT_FILENO) != 0 && (no_color == nullptr || *no_color == '\0');
}

void tell(std::string_view text) { (void)std::fwrite(text.data(), 1, text.size(), stderr); }

void warn(std::string_view line) { tell(fmt::format("sightline: warning: {}\n", line)); }

void set_progress(ProgressKind kind) { progress_kind = kind; }

Progress::Progress(std::string_view label, std::size_t total, bool quiet)
    : label_(label),
      total_(std::max<std::size_t>(total, 1)),
      bar_(!quiet && progress_kind == ProgressKind::automatic && isatty(STDERR_FILENO) != 0),
      lines_(progress_kind == ProgressKind::json) {
  show(0);
}

Progress::~Progress() {
  if (bar_) tell("\r\x1b[K");
  if (lines_ && done_ > 0 && !told_) print_line();
}

void Progress::print_line() {
  tell(fmt::format("{{\"progress\":\"{}\",\"done\":{},\"total\":{}}}\n", label_, done_, total_));
  std::fflush(stderr);
}

void Progress::show(std::size_t done) {
  done_ = done;
  told_ = false;
  if (!bar_ && !lines_) return;
  const auto now = std::chrono::steady_clock::now();
  if (done > 0 && now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  told_ = true;
  if (lines_) {
    print_line();
    return;
  }
  constexpr std::size_t width = 30;
  const std::size_t filled = std::min(done, total_) * width / total_;
  tell(fmt::format("\r\x1b[K[{}{}] {}/{} {}", std::string(filled, '#'), std::string(width - filled, '.'), done, total_,
                   label_));
  std::fflush(stderr);
}

}  // namespace sightline::cli
