// Ctrl-C as a question that loops ask between two frames. A second Ctrl-C ends the program at once.
#pragma once

namespace sightline::cli {

/// From now on SIGINT and SIGTERM only set a flag, the first time.
void catch_interrupts();
bool interrupted();

}  // namespace sightline::cli
