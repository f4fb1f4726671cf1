#include "sightline/core/face_culler.hpp"

#include <bit>

namespace sightline {

std::span<std::uint64_t> FaceSet::add(ObjectId object, std::size_t triangles, bool all) {
  const std::size_t first = words_.size(), count = (triangles + 63) / 64;
  parts_.push_back({object, static_cast<std::uint32_t>(triangles), first});
  words_.resize(first + count, all ? ~std::uint64_t{0} : 0);
  if (all && triangles % 64 != 0) words_.back() = (std::uint64_t{1} << (triangles % 64)) - 1;
  return {words_.data() + first, count};
}

std::size_t FaceSet::count(const Part& part) const {
  std::size_t total = 0;
  for (std::size_t w = 0; w < (std::size_t{part.triangles} + 63) / 64; ++w)
    total += static_cast<std::size_t>(std::popcount(words_[part.first_word + w]));
  return total;
}

std::size_t FaceSet::count() const {
  std::size_t total = 0;
  for (const std::uint64_t word : words_) total += static_cast<std::size_t>(std::popcount(word));
  return total;
}

}  // namespace sightline
