#include "sightline/index/large_pages.hpp"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace sightline {
namespace {

constexpr std::size_t page = std::size_t{1} << 21, least = 2 * page;
constexpr std::size_t cache_line = 64;

std::align_val_t alignment(std::size_t bytes) { return std::align_val_t{bytes >= least ? page : cache_line}; }

}  // namespace

void* allocate_pages(std::size_t bytes) {
  void* memory = ::operator new(bytes, alignment(bytes));
#ifdef __linux__
  // A wish: without large pages everything works as well, only slower.
  if (bytes >= least) (void)madvise(memory, bytes, MADV_HUGEPAGE);
#endif
  return memory;
}

void free_pages(void* memory, std::size_t bytes) noexcept { ::operator delete(memory, alignment(bytes)); }

}  // namespace sightline
