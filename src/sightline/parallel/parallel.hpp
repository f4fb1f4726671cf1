// The one way to use threads: a loop over an index range in blocks, on oneTBB. Blocks are the same for any number of
// threads, so a result that depends only on the block stays the same bit by bit.
#pragma once

#include <cstddef>
#include <functional>

namespace sightline {

/// Calls body(begin, end) for consecutive blocks of at most `block` indices that cover [0, count), possibly at once.
/// body must not throw.
void parallel_blocks(std::size_t count, std::size_t block, const std::function<void(std::size_t, std::size_t)>& body);

/// Limits all parallel work of this process to so many threads while it lives; 0 leaves the machine's number.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  void* control_ = nullptr;
};

/// How many threads parallel work may use now.
int thread_count();

}  // namespace sightline
