#include "byre/base/shared.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(Shared, SharesMemoryUntilACopyChanges) {
  Shared<std::string> first(std::string("map"));
  const Shared<std::string> second = first;
  EXPECT_EQ(&*first, &*second);
  first.edit() += "s";
  EXPECT_EQ(*first, "maps");
  EXPECT_EQ(*second, "map");
}

TEST(Shared, ChangesInPlaceWithoutCopies) {
  Shared<std::vector<int>> list(std::vector<int>{1, 2});
  const std::vector<int>* const before = &*list;
  list.edit().push_back(3);
  EXPECT_EQ(&*list, before);
  { const Shared<std::vector<int>> copy = list; }
  list.edit().push_back(4);
  EXPECT_EQ(&*list, before) << "the copy is gone";
  EXPECT_EQ(list->size(), 4u);
}

TEST(Shared, StartsWithTheDefaultValue) {
  EXPECT_EQ(*Shared<int>(), 0);
}

}  // namespace
}  // namespace byre
