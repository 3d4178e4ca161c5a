#include "byre/localisation/standing_hint.h"

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

TEST(StandingHint, StartsWithTheNextFrameAndExpires) {
  constexpr Timestamp kSecond(1'000'000'000);
  StandingHint standing;
  standing.pass(Timestamp{});
  EXPECT_FALSE(standing.get());
  standing.give(hint_at(1.0));
  for (int second = 100; second < 110; ++second) {
    standing.pass(second * kSecond);
    EXPECT_TRUE(standing.get()) << second;
  }
  standing.pass(110 * kSecond);
  EXPECT_FALSE(standing.get());
}

TEST(StandingHint, IsReplacedByAnother) {
  StandingHint standing;
  standing.give(hint_at(1.0));
  standing.give(hint_at(2.0));
  ASSERT_TRUE(standing.get());
  EXPECT_EQ(standing.get()->map_from_body.translation.x(), 2.0);
}

TEST(StandingHint, IsWithdrawnByANonFiniteHint) {
  StandingHint standing;
  standing.give(hint_at(1.0));
  standing.give(hint_at(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(standing.get());
}

}  // namespace
}  // namespace byre
