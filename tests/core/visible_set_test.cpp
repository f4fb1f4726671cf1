// Sets of object ids against std::set, over sizes around the words of the bit mask.
#include "sightline/core/visible_set.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "properties.hpp"

namespace sightline {
namespace {

TEST(VisibleSet, StartsEmpty) {
  const VisibleSet none;
  EXPECT_EQ(none.universe(), 0u);
  EXPECT_EQ(none.count(), 0u);
  EXPECT_TRUE(none.is_all());
  const VisibleSet set(100);
  EXPECT_EQ(set.count(), 0u);
  EXPECT_FALSE(set.is_all());
  for (ObjectId id = 0; id < 100; ++id) EXPECT_FALSE(set.contains(id));
}

TEST(VisibleSet, AllIsAscendingForEverySize) {
  for (const std::size_t n : {0u, 1u, 63u, 64u, 65u, 127u, 128u, 129u, 1000u}) {
    const VisibleSet all = VisibleSet::all(n);
    EXPECT_EQ(all.count(), n);
    EXPECT_TRUE(all.is_all());
    ASSERT_EQ(all.order().size(), n);
    for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(all.order()[i], i);
  }
}

TEST(VisibleSet, KeepsTheOrderOfInsertion) {
  VisibleSet set(200);
  for (const ObjectId id : {150u, 3u, 199u, 3u, 0u, 150u, 64u}) set.insert(id);
  EXPECT_EQ(std::vector<ObjectId>(set.order().begin(), set.order().end()), (std::vector<ObjectId>{150, 3, 199, 0, 64}));
  EXPECT_EQ(set.sorted(), (std::vector<ObjectId>{0, 3, 64, 150, 199}));
  EXPECT_EQ(set.count(), 5u);
}

TEST(VisibleSet, ResetForgetsAndResizes) {
  VisibleSet set = VisibleSet::all(500);
  set.reset(70);
  EXPECT_EQ(set.universe(), 70u);
  EXPECT_EQ(set.count(), 0u);
  for (ObjectId id = 0; id < 70; ++id) EXPECT_FALSE(set.contains(id));
  set.reset(300);
  for (ObjectId id = 0; id < 300; ++id) EXPECT_FALSE(set.contains(id));
}

RC_GTEST_PROP(VisibleSetProperty, IsASet, ()) {
  const auto universe = *rc::gen::inRange<std::uint32_t>(1, 200);
  const auto ids = rc::gen::container<std::vector<ObjectId>>(rc::gen::inRange<ObjectId>(0, universe));
  const std::vector<ObjectId> in_a = *ids, in_b = *ids;
  const std::set<ObjectId> model_a(in_a.begin(), in_a.end()), model_b(in_b.begin(), in_b.end());
  VisibleSet a(universe), b(universe);
  for (const ObjectId id : in_a) a.insert(id);
  for (const ObjectId id : in_b) b.insert(id);
  const auto as_model = [](const VisibleSet& set) {
    const std::vector<ObjectId> sorted = set.sorted();
    RC_ASSERT(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end());
    return std::set<ObjectId>(sorted.begin(), sorted.end());
  };
  RC_ASSERT(as_model(a) == model_a);
  for (ObjectId id = 0; id < universe; ++id) RC_ASSERT(a.contains(id) == (model_a.count(id) == 1));
  RC_ASSERT(a.subset_of(b) == std::includes(model_b.begin(), model_b.end(), model_a.begin(), model_a.end()));
  std::set<ObjectId> both(model_a), only_a;
  both.insert(model_b.begin(), model_b.end());
  std::set_difference(model_a.begin(), model_a.end(), model_b.begin(), model_b.end(),
                      std::inserter(only_a, only_a.end()));
  RC_ASSERT(as_model(set_union(a, b)) == both);
  RC_ASSERT(as_model(set_difference(a, b)) == only_a);
  RC_ASSERT(a.subset_of(set_union(a, b)));
  RC_ASSERT(set_difference(a, b).subset_of(a));
}

TEST(VisibleSet, InsertNewIsInsertOfEach) {
  VisibleSet one(200), other(200);
  const std::vector<ObjectId> ids{5, 199, 64, 0, 63};
  one.insert(7);
  other.insert(7);
  one.insert_new(ids);
  for (const ObjectId id : ids) other.insert(id);
  EXPECT_EQ(one.sorted(), other.sorted());
  EXPECT_TRUE(std::equal(one.order().begin(), one.order().end(), other.order().begin(), other.order().end()));
  for (ObjectId id = 0; id < 200; ++id) EXPECT_EQ(one.contains(id), other.contains(id)) << id;
}

}  // namespace
}  // namespace sightline
