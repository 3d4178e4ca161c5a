// `byre node` with wheel odometry from another vendor's program.

#include "node_fixture.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include <gmock/gmock.h>

namespace byre::testing_ros2 {
namespace {

using std::chrono_literals::operator""ms;

constexpr double kFrameRate = 5.0;  // Hz
constexpr int kFrames = 76;
constexpr int kFirstDark = 70;
constexpr int kWheelSamplesPerFrame = 4;

// A base that drives three metres through the middle of the room, in bends to both sides.
Pose room_from_base(double seconds) {
  constexpr double kStep = 0.01;
  constexpr double kSpeed = 0.22;  // metres per second
  Pose pose{Eigen::Quaterniond::Identity(), {-1.5, 0.0, 0.0}};
  for (double t = 0.0; t < seconds - 0.5 * kStep; t += kStep) {
    pose = pose * Pose{rotation_exp({0.0, 0.0, 0.7 * std::cos(0.9 * t) * kStep}), {kSpeed * kStep, 0.0, 0.0}};
  }
  return pose;
}

nav_msgs::msg::Odometry wheel_message(Timestamp time) {
  const Pose pose = room_from_base(to_seconds(time));
  nav_msgs::msg::Odometry message;
  message.header().stamp(ros_time(time));
  message.header().frame_id("odom");
  message.pose().pose().position().x(pose.translation.x());
  message.pose().pose().position().y(pose.translation.y());
  message.pose().pose().orientation().z(pose.rotation.z());
  message.pose().pose().orientation().w(pose.rotation.w());
  return message;
}

// Images of a camera on that base.
class DriveThroughRoom {
 public:
  DriveThroughRoom() : rendered_("byre_ros2_drive", euroc_like_calibration(4), truth()) {
    const auto recording = open_recording(rendered_.folder(), {});
    for (int i = 0; i < recording->size(); ++i) frames_.push_back(*recording->read(i));
    for (std::size_t i = kFirstDark; i < frames_.size(); ++i) {
      std::ranges::fill(frames_[i].left.pixels, std::uint8_t{0});
      std::ranges::fill(frames_[i].right->pixels, std::uint8_t{0});
    }
  }

  const std::vector<ImageFrame>& frames() const { return frames_; }
  Eigen::Vector3d position(std::size_t frame) const { return rendered_.truth()[frame].world_from_body.translation; }

 private:
  static Trajectory truth() {
    const Pose base_from_body = robot_from_camera() * inverse(euroc_like_calibration(4).body_from_left);
    Trajectory truth;
    for (int i = 0; i < kFrames; ++i) {
      truth.push_back({from_seconds(i / kFrameRate), room_from_base(i / kFrameRate) * base_from_body});
    }
    return truth;
  }

  RenderedFixture rendered_;
  std::vector<ImageFrame> frames_;
};

geometry_msgs::msg::TwistStamped twist_message(Timestamp time) {
  constexpr double kStep = 0.01;
  const double seconds = to_seconds(time);
  const Pose motion = inverse(room_from_base(seconds - kStep)) * room_from_base(seconds + kStep);
  geometry_msgs::msg::TwistStamped message;
  message.header().stamp(ros_time(time));
  message.header().frame_id("base_link");
  message.twist().linear().x(motion.translation.x() / (2.0 * kStep));
  message.twist().linear().y(motion.translation.y() / (2.0 * kStep));
  message.twist().angular().z(rotation_log(motion.rotation).z() / (2.0 * kStep));
  return message;
}

class ByreNodeOnWheels : public ByreNode {
 protected:
  // Tests dead reckoning without images. message_of: wheel odometry at a time, as a message of the given type.
  template <typename Message>
  void expect_dead_reckoning(const TypeSupport& type, Message (*message_of)(Timestamp));
};

template <typename Message>
void ByreNodeOnWheels::expect_dead_reckoning(const TypeSupport& type, Message (*message_of)(Timestamp)) {
  const DriveThroughRoom drive;
  auto* const wheels = peer_.writer("rt/wheels", type, kVolatile);
  NodeProcess node(folder_, mapping() + "motion:\n  wheels: /wheels\n", domain_);
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  ASSERT_TRUE(FastPeer::has_subscriber(wheels) && send_acknowledged(wheels, Message()));
  std::vector<Eigen::Vector3d> positions;
  for (std::size_t i = 0; i < drive.frames().size(); ++i) {
    const Timestamp time = drive.frames()[i].time;
    for (int j = kWheelSamplesPerFrame - 1; j >= 0 && i > 0; --j) {
      Message message = message_of(time - from_seconds(j / kFrameRate / kWheelSamplesPerFrame));
      wheels->write(&message);
    }
    const auto odometry = answer_to(feed_, odometry_, drive.frames()[i]);
    ASSERT_TRUE(odometry) << "frame " << i << "\n" << node.stderr_output();
    positions.push_back(vector_of(odometry->pose().pose().position()));
  }
  const double driven = (drive.position(kFrames - 1) - drive.position(kFirstDark - 1)).norm();
  const double told = (positions.back() - positions[kFirstDark - 1]).norm();
  EXPECT_NEAR(told, driven, 0.05 * driven);
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNodeOnWheels, BridgesDarknessByOdometry) {
  expect_dead_reckoning(TypeSupport(new nav_msgs::msg::OdometryPubSubType), wheel_message);
}

TEST_F(ByreNodeOnWheels, BridgesDarknessByVelocities) {
  expect_dead_reckoning(TypeSupport(new geometry_msgs::msg::TwistStampedPubSubType), twist_message);
}

TEST_F(ByreNodeOnWheels, BeginsTheirExtrinsicsWithTheTransformToTheCamera) {
  const Pose base_from_left{Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {0.3, 0.0, 0.5}};
  auto* const wheels = peer_.writer("rt/wheels", TypeSupport(new nav_msgs::msg::OdometryPubSubType), kVolatile);
  auto* const fixed =
      peer_.writer("rt/tf_static", TypeSupport(new tf2_msgs::msg::TFMessagePubSubType), {true, true, 1});
  geometry_msgs::msg::TransformStamped transform;
  transform.header().frame_id("base_link");
  transform.child_frame_id("left_optical");
  transform.transform().translation().x(base_from_left.translation.x());
  transform.transform().translation().z(base_from_left.translation.z());
  transform.transform().rotation().w(base_from_left.rotation.w());
  transform.transform().rotation().x(base_from_left.rotation.x());
  transform.transform().rotation().y(base_from_left.rotation.y());
  transform.transform().rotation().z(base_from_left.rotation.z());
  tf2_msgs::msg::TFMessage mounting;
  mounting.transforms({transform});
  fixed->write(&mounting);
  NodeProcess node(folder_, mapping() + "frames:\n  mounting: tf\nmotion:\n  wheels: /wheels\n", domain_);
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  const std::string choice = "the extrinsics of the wheels on /wheels start with the transform base_link";
  bool is_chosen = false;
  for (int i = 0; i < 100 && !is_chosen; ++i) {
    nav_msgs::msg::Odometry message = wheel_message(from_seconds(0.1 * i));
    message.child_frame_id("base_link");
    wheels->write(&message);
    feed_.send(Room::shared().frames()[0], 100ms * i);
    std::this_thread::sleep_for(100ms);
    is_chosen = node.stderr_output().find(choice) != std::string::npos;
  }
  EXPECT_TRUE(is_chosen) << node.stderr_output();
  EXPECT_EQ(node.stop(), 0);
}

}  // namespace
}  // namespace byre::testing_ros2
