// Ctrl-C: no verb leaves a half-written file, and loops may ask between two steps whether to stop with what they have.
#pragma once

namespace sightline::cli {

/// From now on SIGINT, SIGTERM and SIGHUP end the program as they do by default, but remove unfinished outputs first.
void leave_nothing_unfinished();

/// From now on the first SIGINT or SIGTERM only sets a flag; the second does what leave_nothing_unfinished() says.
void catch_interrupts();
bool interrupted();

}  // namespace sightline::cli
