#include "sightline/parallel/parallel.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace sightline {
namespace {

/// Tells the thread sanitizer, which cannot see into oneTBB, that what happens before start() is seen by every block
/// and what blocks did is seen after join(). Nothing in other builds.
class ForkJoin {
 public:
#ifdef __SANITIZE_THREAD__
  void start() { __tsan_release(&started_); }
  void enter() { __tsan_acquire(&started_); }
  void leave() { __tsan_release(&ended_); }
  void join() { __tsan_acquire(&ended_); }

 private:
  char started_ = 0, ended_ = 0;
#else
  void start() {}
  void enter() {}
  void leave() {}
  void join() {}
#endif
};

}  // namespace

void parallel_blocks(std::size_t count, std::size_t block, const std::function<void(std::size_t, std::size_t)>& body) {
  block = std::max<std::size_t>(block, 1);
  const std::size_t blocks = (count + block - 1) / block;
  if (blocks <= 1) {
    if (count > 0) body(0, count);
    return;
  }
  ForkJoin order;
  order.start();
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
    order.enter();
    body(b * block, std::min(count, (b + 1) * block));
    order.leave();
  });
  order.join();
}

ThreadLimit::ThreadLimit(int threads) {
  if (threads > 0)
    control_ = new tbb::global_control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(control_); }

int thread_count() {
  return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

}  // namespace sightline
