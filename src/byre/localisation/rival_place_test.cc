#include "byre/localisation/rival_place.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

// A camera that goes along x, of which each frame is found so many metres beside where tracking has it.
class RivalOfAWay : public ::testing::Test {
 protected:
  bool find(double along, double beside, double log_odds, double tracked_log_odds) {
    const Pose tracked{Eigen::Quaterniond::Identity(), {-along, 0.0, 0.0}};
    FoundPlace found{
        {}, {Eigen::Quaterniond::Identity(), {-along - beside, 0.0, 0.0}}, 3.0, log_odds, tracked_log_odds};
    return rival_.note(found, tracked, {});
  }
  // Whether the last of ten finds, half a metre apart, is to be believed.
  bool find_along(double beside, double log_odds, double tracked_log_odds) {
    bool is_believed = false;
    for (int i = 0; i < 10; ++i) is_believed = find(0.5 * i, beside, log_odds, tracked_log_odds);
    return is_believed;
  }

  RivalPlace rival_;
};

TEST_F(RivalOfAWay, IsBelievedOnceItWasFoundAgainAndAgain) {
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(find(0.5 * i, 5.0, 4.0, -2.0)) << i;
  EXPECT_TRUE(find(2.0, 5.0, 4.0, -2.0));
}

TEST_F(RivalOfAWay, IsNotBelievedFromOneSpot) {
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(find(0.01 * i, 5.0, 4.0, -2.0)) << i;
}

TEST_F(RivalOfAWay, MustBeMuchMoreLikelyThanTheTrackedPose) {
  EXPECT_FALSE(find_along(5.0, 4.0, 2.0));
  EXPECT_FALSE(find_along(5.0, -1.0, -9.0)) << "a similar bay, where much has changed";
  EXPECT_TRUE(find_along(5.0, 4.0, -1.0));
}

TEST_F(RivalOfAWay, IsNotNearTheWay) {
  EXPECT_FALSE(find_along(0.3, 4.0, -2.0));
}

TEST_F(RivalOfAWay, MustBeOneAndTheSame) {
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(find(0.5 * i, i % 2 == 0 ? 5.0 : -5.0, 4.0, -2.0)) << i;
}

TEST_F(RivalOfAWay, IsForgottenWhereTrackingIsRight) {
  for (int i = 0; i < 4; ++i) find(0.5 * i, 5.0, 4.0, -2.0);
  EXPECT_FALSE(find(2.0, 0.0, 4.0, -2.0));
  EXPECT_FALSE(find(2.5, 5.0, 4.0, -2.0));
}

}  // namespace
}  // namespace byre
