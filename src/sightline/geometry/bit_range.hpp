// Ranges of bits in arrays of words: what a cluster of triangles is in a set of triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace sightline {

/// Sets bits [begin, end), 64 to a word.
inline void set_bits(std::span<std::uint64_t> words, std::size_t begin, std::size_t end) {
  if (begin >= end) return;
  const std::size_t first = begin >> 6, last = (end - 1) >> 6;
  const std::uint64_t low = ~std::uint64_t{0} << (begin & 63), high = ~std::uint64_t{0} >> (63 - ((end - 1) & 63));
  if (first == last) {
    words[first] |= low & high;
    return;
  }
  words[first] |= low;
  for (std::size_t w = first + 1; w < last; ++w) words[w] = ~std::uint64_t{0};
  words[last] |= high;
}

}  // namespace sightline
