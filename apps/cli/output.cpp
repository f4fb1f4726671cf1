#include "output.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "sightline/scene/input_error.hpp"

namespace sightline::cli {

namespace fs = std::filesystem;

OutputFile::OutputFile(fs::path file) : file_(std::move(file)) {
  if (file_ == "-") {
    stream_ = stdout;
    return;
  }
  std::error_code ignored;
  if (fs::is_symlink(file_, ignored)) file_ = fs::weakly_canonical(file_, ignored);
  if (fs::is_directory(file_, ignored)) throw InputError(file_.string(), "", "cannot write: is a folder");
  const bool direct = fs::exists(file_, ignored) && !fs::is_regular_file(file_, ignored);
  if (!direct) temporary_ = file_.string() + fmt::format(".part{}", getpid());
  stream_ = std::fopen(direct ? file_.c_str() : temporary_.c_str(), "wb");
  if (stream_ == nullptr) {
    temporary_.clear();
    fail("cannot write");
  }
}

OutputFile::~OutputFile() {
  if (stream_ != nullptr && stream_ != stdout) std::fclose(stream_);
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove(temporary_, ignored);
}

void OutputFile::fail(const char* what) const {
  throw InputError(file_ == "-" ? "standard output" : file_.string(), "",
                   fmt::format("{}: {}", what, std::strerror(errno)));
}

void OutputFile::write(std::string_view bytes) {
  if (bytes.empty()) return;  // fwrite must not be given a null pointer, whatever the count
  if (std::fwrite(bytes.data(), 1, bytes.size(), stream_) != bytes.size()) fail("cannot write");
}

void OutputFile::commit() {
  if (std::fflush(stream_) != 0) fail("cannot write");
  if (stream_ == stdout) return;
  const bool closed = std::fclose(stream_) == 0;
  stream_ = nullptr;
  if (!closed) fail("cannot write");
  if (temporary_.empty()) return;
  if (std::rename(temporary_.c_str(), file_.c_str()) != 0) fail("cannot put in place");
  temporary_.clear();
}

void flush_stdout() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    throw InputError("standard output", "", fmt::format("cannot write: {}", std::strerror(errno)));
}

bool stdout_has_colour() {
  const char* no_color = std::getenv("NO_COLOR");
  return isatty(STDOUT_FILENO) != 0 && (no_color == nullptr || *no_color == '\0');
}

void warn(std::string_view line) { fmt::print(stderr, "sightline: warning: {}\n", line); }

Progress::Progress(std::string_view label, std::size_t total, bool quiet)
    : label_(label), total_(std::max<std::size_t>(total, 1)), active_(!quiet && isatty(STDERR_FILENO) != 0) {
  show(0);
}

Progress::~Progress() {
  if (active_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::show(std::size_t done) {
  if (!active_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  constexpr std::size_t width = 30;
  const std::size_t filled = std::min(done, total_) * width / total_;
  fmt::print(stderr, "\r\x1b[K[{}{}] {}/{} {}", std::string(filled, '#'), std::string(width - filled, '.'), done,
             total_, label_);
  std::fflush(stderr);
}

}  // namespace sightline::cli
