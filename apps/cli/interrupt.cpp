#include "interrupt.hpp"

#include <csignal>

namespace sightline::cli {
namespace {
volatile std::sig_atomic_t signal_seen = 0;
}  // namespace

void catch_interrupts() {
  struct sigaction action{};
  action.sa_handler = [](int) { signal_seen = 1; };
  // The handler goes after the first signal; what was blocked in a system call goes on.
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() { return signal_seen != 0; }

}  // namespace sightline::cli
