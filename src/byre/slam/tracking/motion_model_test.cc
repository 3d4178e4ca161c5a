#include "byre/slam/tracking/motion_model.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/tracking/body_pose.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

// A camera in front of the body that looks along its x axis.
Rig robot_rig() {
  Rig rig;
  rig.body_from_camera = {rotation_exp({-1.2, 1.2, -1.2}), {0.3, 0.0, 0.1}};
  return rig;
}

const Pose kLast = exp_pose((Vector6() << 1.0, -2.0, 0.5, 0.3, 0.1, -0.2).finished());
const Vector6 kVelocity = (Vector6() << 0.1, 0.0, 1.0, 0.0, 0.2, 0.0).finished();
const Pose kAhead{rotation_exp({0.0, 0.0, 0.1}), {0.2, 0.0, 0.0}};  // last_from_body

TEST(MotionModel, PredictsNoMotionAtFirst) {
  MotionModel motion;
  motion.add_odometry({});
  EXPECT_EQ(motion.predict(kLast, robot_rig(), 0.1), kLast);
  EXPECT_FALSE(motion.measured());
}

TEST(MotionModel, PredictsConstantVelocity) {
  const Pose before = exp_pose(-0.5 * kVelocity) * kLast;
  MotionModel motion;
  motion.set_velocity(log_pose(kLast * inverse(before)) / 0.5);
  motion.add_odometry({});
  const Pose predicted = motion.predict(kLast, robot_rig(), 0.5);
  EXPECT_THAT(predicted * inverse(kLast), PoseNear(kLast * inverse(before), 1e-9, 1e-9));
}

TEST(MotionModel, PrefersMeasuredMotionToConstantVelocity) {
  const Rig rig = robot_rig();
  MotionModel motion;
  motion.set_velocity(kVelocity);
  motion.add_odometry(kAhead);
  const Pose predicted = motion.predict(kLast, rig, 0.1);
  EXPECT_THAT(inverse(body_pose(rig, kLast)) * body_pose(rig, predicted), PoseNear(kAhead, 1e-12, 1e-12));
}

TEST(MotionModel, AccumulatesMeasuredMotionUntilAPose) {
  const Rig rig = robot_rig();
  MotionModel motion;
  motion.set_velocity(kVelocity);
  motion.mark_lost();
  motion.add_odometry(kAhead);
  motion.add_odometry(kAhead);
  EXPECT_THAT(inverse(body_pose(rig, kLast)) * body_pose(rig, motion.predict(kLast, rig, 0.2)),
              PoseNear(kAhead * kAhead, 1e-12, 1e-12));
  motion.set_velocity(kVelocity);
  motion.add_odometry(kAhead);
  EXPECT_THAT(inverse(body_pose(rig, kLast)) * body_pose(rig, motion.predict(kLast, rig, 0.1)),
              PoseNear(kAhead, 1e-12, 1e-12));
}

TEST(MotionModel, IgnoresMeasuredMotionAfterAGapUntilAPose) {
  MotionModel motion;
  motion.set_velocity(kVelocity);
  motion.add_odometry({});
  motion.add_odometry(kAhead);
  EXPECT_FALSE(motion.measured());
  motion.set_velocity(kVelocity);
  motion.add_odometry(kAhead);
  EXPECT_TRUE(motion.measured());
  motion.restore_measured({});
  EXPECT_FALSE(motion.measured());
  motion.restore_measured(kAhead);
  EXPECT_TRUE(motion.measured());
}

TEST(MotionModel, HasNoVelocityAfterALoss) {
  MotionModel motion;
  motion.set_velocity(kVelocity);
  EXPECT_EQ(motion.velocity(), kVelocity);
  motion.mark_lost();
  EXPECT_EQ(motion.velocity(), Vector6(Vector6::Zero()));
}

TEST(MotionModel, FollowsARotationOfTheCameraFrame) {
  const Pose turn{rotation_exp({0.02, -0.01, 0.03}), Eigen::Vector3d::Zero()};
  MotionModel motion, turned;
  motion.set_velocity(kVelocity);
  turned.set_velocity(kVelocity);
  turned.rotate_camera(turn);
  motion.add_odometry({});
  turned.add_odometry({});
  EXPECT_THAT(turned.predict(turn * kLast, robot_rig(), 0.01),
              PoseNear(turn * motion.predict(kLast, robot_rig(), 0.01), 1e-6, 1e-6));
}

TEST(MotionModel, FollowsAChangeOfScale) {
  MotionModel motion;
  motion.set_velocity(kVelocity);
  motion.scale_lengths(2.0);
  EXPECT_EQ(motion.velocity().head<3>(), 2.0 * kVelocity.head<3>());
  EXPECT_EQ(motion.velocity().tail<3>(), kVelocity.tail<3>());
}

}  // namespace
}  // namespace byre
