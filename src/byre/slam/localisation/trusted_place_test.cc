#include "byre/slam/localisation/place_bounds.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(TrustedPlace, ReturnsTheLastTrustedPoseUntilForgotten) {
  TrustedPlace place(2.0);
  EXPECT_FALSE(place.reach_from_there());
  place.note({from_seconds(3.0), Pose{}});
  ASSERT_TRUE(place.reach_from_there());
  EXPECT_EQ(place.reach_from_there()->before.time, from_seconds(3.0));
  EXPECT_EQ(place.reach_from_there()->max_speed, 2.0);
  place.forget();
  EXPECT_FALSE(place.reach_from_there());
}

TEST(TrustedPlace, ReportsEachReasonOnceUntilATrustedPose) {
  TrustedPlace place(2.0);
  EXPECT_FALSE(place.is_new_refusal(DistrustReason::none, Verdict::untrusted));
  EXPECT_TRUE(place.is_new_refusal(DistrustReason::in_wall, Verdict::untrusted));
  EXPECT_FALSE(place.is_new_refusal(DistrustReason::in_wall, Verdict::untrusted));
  EXPECT_TRUE(place.is_new_refusal(DistrustReason::outside, Verdict::untrusted));
  EXPECT_FALSE(place.is_new_refusal(DistrustReason::none, Verdict::trusted));
  EXPECT_TRUE(place.is_new_refusal(DistrustReason::outside, Verdict::untrusted));
}

}  // namespace
}  // namespace byre
