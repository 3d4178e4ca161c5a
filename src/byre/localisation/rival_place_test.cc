#include "byre/localisation/rival_place.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

// A camera that goes along x, of which each frame is found so many metres beside where tracking has it.
class RivalOfAWay : public ::testing::Test {
 protected:
  bool find(double along, double beside, double seen_share, std::optional<double> tracked_share) {
    const Pose tracked{Eigen::Quaterniond::Identity(), {-along, 0.0, 0.0}};
    FoundPlace found{{}, {Eigen::Quaterniond::Identity(), {-along - beside, 0.0, 0.0}}, 3.0, seen_share};
    found.tracked_share = tracked_share;
    return rival_.note(found, tracked, {});
  }
  // Whether the last of ten finds, half a metre apart, is to be believed.
  bool find_along(double beside, double seen_share, std::optional<double> tracked_share) {
    bool is_believed = false;
    for (int i = 0; i < 10; ++i) is_believed = find(0.5 * i, beside, seen_share, tracked_share);
    return is_believed;
  }

  RivalPlace rival_;
};

TEST_F(RivalOfAWay, IsBelievedOnceItWasFoundAgainAndAgain) {
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(find(0.5 * i, 5.0, 0.15, 0.07)) << i;
  EXPECT_TRUE(find(2.0, 5.0, 0.15, 0.07));
}

TEST_F(RivalOfAWay, IsNotBelievedFromOneSpot) {
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(find(0.01 * i, 5.0, 0.15, 0.07)) << i;
}

TEST_F(RivalOfAWay, MustShowMuchMoreThanTrackingSees) {
  EXPECT_FALSE(find_along(5.0, 0.15, 0.12));
  EXPECT_FALSE(find_along(5.0, 0.07, 0.01)) << "as a bay does that looks alike, where much has changed";
  EXPECT_TRUE(find_along(5.0, 0.15, 0.01));
}

TEST_F(RivalOfAWay, IsNoneNearTheWayOrWhereNothingIsExpected) {
  EXPECT_FALSE(find_along(0.3, 0.15, 0.07));
  EXPECT_FALSE(find_along(5.0, 0.15, std::nullopt)) << "beyond the map";
}

TEST_F(RivalOfAWay, MustBeOneAndTheSame) {
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(find(0.5 * i, i % 2 == 0 ? 5.0 : -5.0, 0.15, 0.07)) << i;
}

TEST_F(RivalOfAWay, IsForgottenWhereTrackingIsRight) {
  for (int i = 0; i < 4; ++i) find(0.5 * i, 5.0, 0.15, 0.07);
  EXPECT_FALSE(find(2.0, 0.0, 0.15, 0.07));
  EXPECT_FALSE(find(2.5, 5.0, 0.15, 0.07));
}

}  // namespace
}  // namespace byre
