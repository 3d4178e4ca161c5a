#include "byre/session/odometry.h"

#include "byre/geometry/geometry_matchers.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

Pose at(double x) {
  return {Eigen::Quaterniond::Identity(), {x, 0.0, 0.0}};
}

TEST(Odometry, BeginsWhereTheBodyIs) {
  Odometry odometry;
  odometry.start(at(5.0));
  EXPECT_THAT(odometry.pose(at(5.0)), PoseNear(Pose{}, 1e-12, 1e-12));
  EXPECT_THAT(odometry.pose(at(6.0)), PoseNear(at(1.0), 1e-12, 1e-12));
}

TEST(Odometry, DoesNotJumpWhenTheMapPoseIsCorrected) {
  Odometry odometry;
  odometry.start(at(0.0));
  const Pose before{rotation_exp({0.0, 0.0, 0.3}), {1.0, 2.0, 0.0}};
  const Pose after{rotation_exp({0.0, 0.0, 0.2}), {1.4, 1.9, 0.1}};
  odometry.absorb(before, after);
  EXPECT_THAT(odometry.pose(after), PoseNear(before, 1e-12, 1e-12));
}

TEST(Odometry, FollowsTheBodyAfterACorrection) {
  Odometry odometry;
  odometry.start(at(0.0));
  const Pose before{rotation_exp({0.0, 0.0, 0.3}), {1.0, 2.0, 0.0}};
  const Pose after = at(3.0);
  odometry.absorb(before, after);
  const Pose motion{rotation_exp({0.1, 0.0, 0.0}), {0.2, 0.0, 0.0}};  // of the body, as it sees it itself
  EXPECT_THAT(odometry.pose(after * motion), PoseNear(before * motion, 1e-12, 1e-12));
}

}  // namespace
}  // namespace byre
