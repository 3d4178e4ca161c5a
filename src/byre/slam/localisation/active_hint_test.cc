#include "byre/slam/localisation/place_search.h"

#include <limits>

#include <gtest/gtest.h>

namespace byre {
namespace {

PoseHint hint_at(double x) {
  PoseHint hint;
  hint.map_from_body.translation.x() = x;
  return hint;
}

TEST(PoseHint, RequiresItsPositionAndDirection) {
  Pose pose;
  pose.translation = {4.0, 1.5, 0.0};
  EXPECT_TRUE(is_near(hint_at(5.0), pose));
  EXPECT_FALSE(is_near(hint_at(6.0), pose));
  pose.rotation = rotation_exp({0.0, 0.0, 2.0});
  EXPECT_FALSE(is_near(hint_at(5.0), pose)) << "opposite direction";
}

TEST(ActiveHint, StartsWithTheNextFrameAndExpires) {
  constexpr Timestamp kSecond(1'000'000'000);
  ActiveHint active;
  active.expire(Timestamp{});
  EXPECT_FALSE(active.get());
  active.set_hint(hint_at(1.0));
  for (int second = 100; second < 110; ++second) {
    active.expire(second * kSecond);
    EXPECT_TRUE(active.get()) << second;
  }
  active.expire(110 * kSecond);
  EXPECT_FALSE(active.get());
}

TEST(ActiveHint, IsReplacedByAnother) {
  ActiveHint active;
  active.set_hint(hint_at(1.0));
  active.set_hint(hint_at(2.0));
  ASSERT_TRUE(active.get());
  EXPECT_EQ(active.get()->map_from_body.translation.x(), 2.0);
}

TEST(ActiveHint, IsWithdrawnByANonFiniteHint) {
  ActiveHint active;
  active.set_hint(hint_at(1.0));
  active.set_hint(hint_at(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(active.get());
}

}  // namespace
}  // namespace byre
