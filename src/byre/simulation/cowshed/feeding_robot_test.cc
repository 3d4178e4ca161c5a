#include "byre/simulation/cowshed/feeding_robot.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/simulation/pixel_rays.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

namespace byre {
namespace {

using Eigen::Vector3d;

double heading_of(const Pose& world_from_body) {
  const Vector3d forward = world_from_body.rotation * Vector3d::UnitX();
  return std::atan2(forward.y(), forward.x());
}

TEST(FeedingRobot, LooksForwardFromAboveTheFloor) {
  const Calibration calibration = feeding_robot_calibration(1);
  const Vector3d axis_in_body = calibration.body_from_left.rotation * Vector3d::UnitZ();
  EXPECT_GT(axis_in_body.x(), 0.999);
  const Vector3d down_in_body = calibration.body_from_left.rotation * Vector3d::UnitY();
  EXPECT_LT(down_in_body.z(), -0.999);
  EXPECT_NEAR(calibration.body_from_left.translation.z(), 0.9, 1e-9);
  EXPECT_NEAR(inverse(calibration.right->right_from_left).translation.norm(), 0.15, 1e-4);
}

TEST(FeedingRobot, HasTheSameViewWithSmallerImages) {
  const Camera whole = feeding_robot_calibration(1).left;
  const Camera small = feeding_robot_calibration(4).left;
  EXPECT_EQ(small.width, 188);
  EXPECT_EQ(small.height, 120);
  const Vector3d point(0.4, -0.2, 2.0);
  const Eigen::Vector2d expected = (whole.project(point).value().array() + 0.5) / 4.0 - 0.5;
  EXPECT_LT((small.project(point).value() - expected).norm(), 1e-9);
}

TEST(FeedingRobot, HasTheSameViewWidthWithAnotherAspectRatio) {
  const Camera whole = feeding_robot_calibration(1).left;
  const Camera wide = resized_camera(whole, 1280, 720);
  EXPECT_EQ(wide.width, 1280);
  EXPECT_EQ(wide.height, 720);
  const Vector3d point(0.4, -0.2, 2.0);
  const Eigen::Vector2d from_middle = whole.project(point).value() - Eigen::Vector2d(375.5, 239.5);
  const Eigen::Vector2d expected = Eigen::Vector2d(639.5, 359.5) + 1280.0 / 752.0 * from_middle;
  EXPECT_LT((wide.project(point).value() - expected).norm(), 1e-9);
  EXPECT_EQ(resized_camera(whole, 752, 480).cy, whole.cy);
}

TEST(FeedingCourse, ReturnsToItsStartAndAMetreFurther) {
  for (const double duration_s : {40.0, 55.0, 150.0}) {
    const FeedingCourse course({.duration_s = duration_s});
    const Pose begin = course.world_from_body(0.0);
    const Pose end = course.world_from_body(duration_s);
    const Vector3d way = end.translation - begin.translation;
    EXPECT_NEAR(way.x(), 1.0, 0.02) << duration_s;
    EXPECT_NEAR(way.y(), 0.0, 0.01) << duration_s;
    EXPECT_NEAR(heading_of(end), 0.0, 0.01) << duration_s;
  }
}

TEST(FeedingCourse, ReturnsOnTheOtherSideInTheOppositeDirection) {
  const FeedingCourse course({.lane_distance = 2.3, .duration_s = 40.0});
  const Pose there = course.world_from_body(6.0);
  EXPECT_NEAR(there.translation.y(), -1.15, 1e-6);
  EXPECT_NEAR(heading_of(there), 0.0, 0.01);
  bool came_back = false;
  for (double time_s = 20.0; time_s < 30.0; time_s += 0.1) {
    const Pose pose = course.world_from_body(time_s);
    if (std::abs(pose.translation.y() - 1.15) > 1e-6) continue;
    came_back = true;
    EXPECT_NEAR(std::abs(heading_of(pose)), M_PI, 0.01);
  }
  EXPECT_TRUE(came_back);
}

TEST(FeedingCourse, TurnsOnTheSpotAndReturnsOnTheSameLane) {
  const FeedingCourse course({.turn = TurnKind::spot, .duration_s = 60.0});
  double fastest_spin = 0.0;  // radians per second
  double spun = 0.0;          // radians turned while nearly at rest
  for (double time_s = 3.0; time_s < 60.0; time_s += 0.1) {
    const Pose before = course.world_from_body(time_s - 0.1);
    const Pose here = course.world_from_body(time_s);
    EXPECT_NEAR(here.translation.y(), 0.0, 1e-6) << time_s;
    const double turn = angle_between(before.rotation, here.rotation);
    fastest_spin = std::max(fastest_spin, turn / 0.1);
    if ((here.translation - before.translation).head<2>().norm() < 1e-9) spun += turn;
  }
  EXPECT_NEAR(spun, 2.0 * M_PI, 0.3);
  EXPECT_NEAR(fastest_spin, M_PI / 3.0, 0.1);
}

double farthest_x(const FeedingCourse& course, double duration_s) {
  double farthest = 0.0;
  for (double time_s = 0.0; time_s < duration_s; time_s += 0.1) {
    farthest = std::max(farthest, course.world_from_body(time_s).translation.x());
  }
  return farthest;
}

TEST(FeedingCourse, TurnsAtItsFarEndIfLongEnough) {
  constexpr double kTurn = 2.1;  // metres that the turn adds
  for (const double duration_s : {50.0, 70.0}) {
    const FeedingCourse course({.far_x = 24.0, .latest_near_x = 18.0, .duration_s = duration_s});
    EXPECT_NEAR(farthest_x(course, duration_s), 24.0 + kTurn, 0.1) << duration_s;
  }
}

TEST(FeedingCourse, StartsOnTimeIfShort) {
  const FeedingCourse course({.far_x = 24.0, .latest_near_x = 18.0, .duration_s = 10.0});
  EXPECT_LT(course.world_from_body(0.0).translation.x(), 18.1);
  EXPECT_LT(farthest_x(course, 10.0), 24.0);
}

TEST(FeedingCourse, HasSmallAccelerations) {
  constexpr double kStep_s = 0.05;
  const FeedingCourse course({.duration_s = 40.0});
  for (double time_s = kStep_s; time_s < 40.0 - kStep_s; time_s += kStep_s) {
    const Pose before = course.world_from_body(time_s - kStep_s);
    const Pose here = course.world_from_body(time_s);
    const Pose after = course.world_from_body(time_s + kStep_s);
    const Vector3d acceleration =
        (after.translation - 2.0 * here.translation + before.translation) / (kStep_s * kStep_s);
    EXPECT_LT(acceleration.head<2>().norm(), 0.7) << time_s;
    EXPECT_LT(angle_between(before.rotation, after.rotation) / (2.0 * kStep_s), 1.3) << time_s;
    EXPECT_LE((after.translation - before.translation).head<2>().norm() / (2.0 * kStep_s), 0.8);
  }
}

TEST(FeedingCourse, ShakesOnlyWhileDriving) {
  const FeedingCourse course({.duration_s = 40.0});
  const auto tilt = [&](double time_s) {
    const Vector3d up = course.world_from_body(time_s).rotation * Vector3d::UnitZ();
    return std::acos(std::min(up.z(), 1.0));
  };
  EXPECT_NEAR(tilt(0.0), 0.0, 1e-6);
  double most = 0.0;
  for (double time_s = 5.0; time_s < 35.0; time_s += 0.05) most = std::max(most, tilt(time_s));
  EXPECT_GT(most, 0.002);
  EXPECT_LT(most, 0.02);
}

TEST(FeedingCourse, StartsElsewhereOnTheLapOnRequest) {
  const FeedingCourse whole({.duration_s = 40.0});
  const FeedingCourse later({.duration_s = 40.0, .start = 0.1});
  const Vector3d way = later.world_from_body(0.0).translation - whole.world_from_body(0.0).translation;
  EXPECT_NEAR(way.y(), 0.0, 1e-9);
  EXPECT_GT(way.x(), 1.0);
}

}  // namespace
}  // namespace byre
