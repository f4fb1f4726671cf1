#include "viewer/standing.hpp"

namespace sightline::viewer {

std::vector<Standing> standings(const VisibleSet& frustum, const VisibleSet* large, const VisibleSet& visible) {
  std::vector<Standing> all(visible.universe(), Standing::occluded);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto id = static_cast<ObjectId>(i);
    if (visible.contains(id))
      all[i] = Standing::seen;
    else if (!frustum.contains(id))
      all[i] = Standing::outside;
    else if (large != nullptr && !large->contains(id))
      all[i] = Standing::detail;
  }
  return all;
}

std::array<std::size_t, 4> count(std::span<const Standing> standings) {
  std::array<std::size_t, 4> counts{};
  for (const Standing s : standings) ++counts[static_cast<std::size_t>(s)];
  return counts;
}

std::vector<std::uint32_t> colours_of(std::span<const Standing> standings) {
  std::vector<std::uint32_t> colours;
  colours.reserve(standings.size());
  for (const Standing s : standings) colours.push_back(looks[static_cast<std::size_t>(s)].colour);
  return colours;
}

}  // namespace sightline::viewer
