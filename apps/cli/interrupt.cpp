#include "interrupt.hpp"

#include <csignal>

#include "sightline/scene/save/output_file.hpp"

namespace sightline::cli {
namespace {

volatile std::sig_atomic_t signal_seen = 0;

/// Only what is safe in a signal handler.
void handle(int number, void (*handler)(int)) {
  struct sigaction action{};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;  // what was blocked in a system call goes on
  sigaction(number, &action, nullptr);
}

void clean_and_die(int number) {
  remove_unfinished_files();
  handle(number, SIG_DFL);
  raise(number);
}

void take_note(int number) {
  signal_seen = 1;
  handle(number, clean_and_die);
}

}  // namespace

void leave_nothing_unfinished() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) handle(number, clean_and_die);
}

void catch_interrupts() {
  for (const int number : {SIGINT, SIGTERM}) handle(number, take_note);
}

bool interrupted() { return signal_seen != 0; }

}  // namespace sightline::cli
