// Memory of large structures in large pages where the system has them (Linux, transparent huge pages on request): a ray
// touches memory all over a tree, and with pages of four kilobytes most of its time goes into finding them.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace sightline {

/// At least `bytes` bytes; throws std::bad_alloc. From a few megabytes on aligned to large pages.
void* allocate_pages(std::size_t bytes);
void free_pages(void* memory, std::size_t bytes) noexcept;

/// An allocator for vectors.
template <class T>
struct LargePages {
  using value_type = T;
  LargePages() = default;
  template <class U>
  LargePages(const LargePages<U>& /*other*/) {}  // NOLINT(google-explicit-constructor): allocators convert
  T* allocate(std::size_t n) {
    if (n > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_alloc();
    return static_cast<T*>(allocate_pages(n * sizeof(T)));
  }
  void deallocate(T* memory, std::size_t n) noexcept { free_pages(memory, n * sizeof(T)); }
  friend bool operator==(const LargePages&, const LargePages&) { return true; }
};

template <class T>
using PagedVector = std::vector<T, LargePages<T>>;

}  // namespace sightline
