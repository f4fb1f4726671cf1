#include "sightline/scene/load/child_process.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <string>

#include "sightline/scene/input_error.hpp"

namespace sightline {

namespace {

// Sanitizers reserve terabytes of addresses, which a limit would deny them.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool limits_memory = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool limits_memory = false;
#else
constexpr bool limits_memory = true;
#endif
#else
constexpr bool limits_memory = true;
#endif

/// Codes by which the child says how it ended.
enum : int { child_done = 0, child_failed = 10, child_out_of_memory = 11 };

/// Bytes of addresses in use; the largest number where the system does not tell.
std::uint64_t address_space() {
  std::uint64_t pages = 0;
  if (!(std::ifstream("/proc/self/statm") >> pages)) return RLIM_INFINITY;
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

void limit(int resource, std::uint64_t value) {
  rlimit limits{};
  getrlimit(static_cast<__rlimit_resource>(resource), &limits);
  limits.rlim_cur = std::min<rlim_t>(value, limits.rlim_max);
  setrlimit(static_cast<__rlimit_resource>(resource), &limits);
}

[[noreturn]] void be_the_child(std::uint64_t file_size, int descriptor, const std::function<void(ByteSink&)>& work) {
  // Not the caller's handlers, and no core file for a crash that is expected.
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGXCPU})
    std::signal(number, SIG_DFL);
  limit(RLIMIT_CORE, 0);
  // What the library says while it dies is not for the caller's terminal.
  if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
  limit(RLIMIT_CPU, 5 + file_size / 1'000'000);
  const std::uint64_t used = address_space();
  if (limits_memory && used != RLIM_INFINITY) limit(RLIMIT_AS, used + (std::uint64_t{8} << 30) + 64 * file_size);
  ByteSink sink(descriptor);
  try {
    work(sink);
  } catch (const std::bad_alloc&) {
    _exit(child_out_of_memory);
  } catch (const std::exception& error) {
    sink.write(error.what(), std::strlen(error.what()));
    _exit(child_failed);
  } catch (...) {
    _exit(child_failed);
  }
  _exit(child_done);
}

Bytes read_all(int descriptor) {
  Bytes bytes;
  std::array<std::byte, 65536> piece;
  while (true) {
    const ssize_t count = read(descriptor, piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return bytes;
    bytes.insert(bytes.end(), piece.begin(), piece.begin() + count);
  }
}

int wait_for(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

/// Closes and reaps also where reading throws.
struct Child {
  pid_t process;
  int descriptor;
  bool waited = false;

  int wait() {
    waited = true;
    return wait_for(process);
  }
  ~Child() {
    close(descriptor);
    if (waited) return;
    kill(process, SIGKILL);
    wait_for(process);
  }
};

[[noreturn]] void complain(const std::filesystem::path& file, int status, const Bytes& bytes) {
  std::string reason = "is broken in a way that its reader does not survive";
  if (WIFSIGNALED(status)) {
    if (WTERMSIG(status) == SIGXCPU) reason = "takes too long to read";
    if (WTERMSIG(status) == SIGINT || WTERMSIG(status) == SIGTERM || WTERMSIG(status) == SIGKILL)
      reason = "reading it was stopped";
  } else if (WEXITSTATUS(status) == child_out_of_memory) {
    reason = "needs more memory than there is";
  } else if (WEXITSTATUS(status) == child_failed && !bytes.empty()) {
    reason = one_line({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }
  throw InputError(file.string(), "", reason.empty() ? "cannot be read" : reason);
}

}  // namespace

void ByteSink::write(const void* bytes, std::size_t count) {
  const char* from = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t written = ::write(descriptor_, from, count);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) _exit(child_failed);
    from += written;
    count -= static_cast<std::size_t>(written);
  }
}

Bytes run_in_child(const std::filesystem::path& file, const std::function<void(ByteSink&)>& work) {
  std::error_code ignored;
  const std::uint64_t size = std::filesystem::file_size(file, ignored);
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw InputError(file.string(), "", std::string("no pipe: ") + std::strerror(errno));
  const pid_t process = fork();
  if (process < 0) {
    close(ends[0]);
    close(ends[1]);
    throw InputError(file.string(), "", std::string("no process to read it: ") + std::strerror(errno));
  }
  if (process == 0) {
    close(ends[0]);
    be_the_child(ignored ? 0 : size, ends[1], work);
  }
  close(ends[1]);
  Child child{process, ends[0]};
  Bytes bytes = read_all(child.descriptor);
  const int status = child.wait();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != child_done) complain(file, status, bytes);
  return bytes;
}

}  // namespace sightline
