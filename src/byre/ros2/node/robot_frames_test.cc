#include "byre/ros2/node/robot_frames.h"

#include "byre/io/ros/message_matchers.h"
#include "byre/playback/report/ros_report.h"

#include <cmath>

#include <gtest/gtest.h>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

// A base that drives and turns.
Pose path(double seconds) {
  return {rotation_exp({0.0, 0.0, 0.8 * std::sin(seconds)}), {0.6 * seconds, 0.3 * std::sin(seconds), 0.0}};
}

double distance(const Pose& a, const Pose& b) {
  return (a.translation - b.translation).norm() + angle_between(a.rotation, b.rotation);
}

ros::TFMessage tf_message(const std::string& parent, const std::string& child, const Pose& pose, Timestamp time = {}) {
  return {{transform_message({ros::to_time(time), parent}, child, pose)}};
}

class Frames : public testing::Test {
 protected:
  // Transforms odom -> base_link at 50 Hz, up to and including the last time.
  void drive(Timestamp first, Timestamp last, const Pose& odom_from_world = {}) {
    for (Timestamp time = first; time <= last; time += 20ms) {
      frames_.take(tf_message("odom", "base_link", odom_from_world * path(to_seconds(time)), time), time);
    }
  }

  RobotFrames frames_{{"map", "odom", "base_link"}};
};

TEST_F(Frames, InterpolateByStamp) {
  EXPECT_FALSE(frames_.has_base_owner());
  EXPECT_FALSE(frames_.odom_from_base(1s));
  drive(1s, 2s);
  EXPECT_TRUE(frames_.has_base_owner());
  for (const Timestamp time : {1s + 0ms, 1s + 7ms, 1s + 513ms, 2s + 0ms}) {
    const auto pose = frames_.odom_from_base(time);
    ASSERT_TRUE(pose);
    EXPECT_LT(distance(*pose, path(to_seconds(time))), 2e-4);
  }
}

TEST_F(Frames, ExtrapolateWithinABound) {
  drive(1s, 2s);
  const auto pose = frames_.odom_from_base(2s + 20ms);
  ASSERT_TRUE(pose);
  EXPECT_LT(distance(*pose, path(2.02)), 1e-3);
  EXPECT_TRUE(frames_.odom_from_base(2s + 100ms));
  EXPECT_FALSE(frames_.odom_from_base(2s + 101ms));
  EXPECT_FALSE(frames_.odom_from_base(999ms)) << "before the first transform";
}

TEST_F(Frames, RefuseALongGap) {
  drive(1s, 1s + 200ms);
  drive(2s, 2s + 200ms);
  EXPECT_FALSE(frames_.odom_from_base(1s + 600ms));
  EXPECT_TRUE(frames_.odom_from_base(2s + 105ms));
}

TEST_F(Frames, FollowAResetOfOdometryWithoutABlend) {
  const Pose reset = inverse(path(2.0));
  drive(1s, 2s);
  drive(2s + 20ms, 3s, reset);
  EXPECT_FALSE(frames_.odom_from_base(2s + 10ms)) << "between the old and the new frame";
  const auto pose = frames_.odom_from_base(2s + 510ms);
  ASSERT_TRUE(pose);
  EXPECT_LT(distance(*pose, reset * path(2.51)), 2e-4);
}

TEST_F(Frames, FollowAClockThatIsSetBack) {
  drive(10s, 11s);
  drive(1s, 2s);
  EXPECT_FALSE(frames_.odom_from_base(10s + 510ms));
  EXPECT_TRUE(frames_.odom_from_base(1s + 510ms));
}

TEST_F(Frames, PassThroughTheFootprint) {
  const Pose footprint_from_base{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.1}};
  frames_.take_static(tf_message("/base_footprint", "/base_link", footprint_from_base));
  EXPECT_EQ(frames_.root_of_base(), "base_footprint");
  EXPECT_TRUE(frames_.has_base_owner()) << "a second parent of base_link would break the tree";
  EXPECT_FALSE(frames_.odom_from_base(1s));
  frames_.take(tf_message("odom", "base_footprint", path(1.0), 1s), 1s);
  EXPECT_EQ(frames_.root_of_base(), "odom");
  const auto pose = frames_.odom_from_base(1s);
  ASSERT_TRUE(pose);
  EXPECT_LT(distance(*pose, path(1.0) * footprint_from_base), 1e-9);
}

TEST_F(Frames, ReportTheArrivalOfOdometry) {
  EXPECT_FALSE(frames_.last_odometry());
  frames_.take_static(tf_message("base_footprint", "base_link", {}));
  EXPECT_FALSE(frames_.last_odometry()) << "it does not lead to odom";
  frames_.take(tf_message("odom", "base_footprint", path(1.0), 1s), 7s);
  EXPECT_EQ(frames_.last_odometry(), 7s);
  frames_.take(tf_message("wheel", "tyre", path(1.0), 1s), 8s);
  EXPECT_EQ(frames_.last_odometry(), 7s) << "of other frames";
  frames_.take(tf_message("odom", "base_footprint", path(1.1), 2s), 9s);
  EXPECT_EQ(frames_.last_odometry(), 9s);
}

TEST_F(Frames, EndAtACircle) {
  frames_.take_static(tf_message("a", "base_link", {}));
  frames_.take_static(tf_message("base_link", "a", {}));
  EXPECT_FALSE(frames_.odom_from_base(1s));
  EXPECT_FALSE(frames_.root_of_base().empty());
}

TEST_F(Frames, ReportAnotherOwnerOfMapToOdomWhileItLives) {
  EXPECT_FALSE(frames_.has_odom_owner(1s));
  frames_.take(tf_message("map", "odom", {}, 1s), 1s);
  EXPECT_TRUE(frames_.has_odom_owner(5s));
  EXPECT_FALSE(frames_.has_odom_owner(7s));
}

TEST_F(Frames, IgnoreInvalidTransforms) {
  ros::TFMessage broken = tf_message("odom", "base_link", {}, 1s);
  broken.transforms[0].transform.rotation.w = 5.0;
  frames_.take(broken, 1s);
  EXPECT_FALSE(frames_.has_base_owner());
}

// map -> base stays true while odometry of the owner drifts and restarts.
TEST_F(Frames, KeepTheMapPoseWhileOdometryDriftsAndIsReset) {
  PoseFrames published;
  Pose odom_from_world;
  int compared = 0;
  for (Timestamp time = 1s; time < 9s; time += 20ms) {
    odom_from_world = Pose{rotation_exp({0.0, 0.0, 2e-4}), {5e-4, -3e-4, 0.0}} * odom_from_world;
    if (time == 5s) odom_from_world = inverse(path(5.0));
    frames_.take(tf_message("odom", "base_link", odom_from_world * path(to_seconds(time)), time), time);
    const Timestamp image = time + 13ms;  // ahead of the transforms
    FrameReport report;
    report.state = State::tracking;
    report.map_from_body = path(to_seconds(image));
    report.health.verdict = Verdict::trusted;
    const auto odom_from_base = frames_.odom_from_base(image);
    published.note(report, odom_from_base);
    EXPECT_FALSE(published.is_odometry_own());
    if (!odom_from_base) continue;
    const Pose true_odom_from_base = odom_from_world * path(to_seconds(image));
    EXPECT_LT(distance(*published.map_from_odom() * true_odom_from_base, *report.map_from_body), 1e-3);
    ++compared;
  }
  EXPECT_GE(compared, 397) << "all but the first transforms after the start and the reset";
}

}  // namespace
}  // namespace byre
