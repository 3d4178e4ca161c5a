#include "byre/slam/frame/still_image.h"

#include "byre/slam/tracking/mission_scene.h"

#include <random>

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr double kRate = 10.0;  // frames per second
constexpr int kFreeze = 20;     // frame from which the image is repeated

// A drive on a quarter of a circle of 2 m radius at 0.8 m/s with some repeated frames.
class StillImageOnADrive : public ::testing::Test {
 protected:
  // A frame with sensor noise: pixels moved by at most one, one bit of each descriptor changed, a fifth not found.
  Frame with_noise(int image, int at) {
    const Features& features = *mission_.frames[static_cast<std::size_t>(image)].features;
    std::vector<Keypoint> keypoints;
    std::vector<Descriptor> descriptors;
    for (int i = 0; i < features.size(); ++i) {
      if (random_() % 5 == 0) continue;
      Keypoint keypoint = features.keypoint(i);
      const auto step = [&] { return static_cast<float>(random_() % 3) - 1.0f; };
      keypoint.pixel += Eigen::Vector2f(step(), step());
      keypoint.pixel = keypoint.pixel.cwiseMax(0.0f).cwiseMin(
          Eigen::Vector2f(static_cast<float>(mission_.rig.width - 1), static_cast<float>(mission_.rig.height - 1)));
      keypoints.push_back(keypoint);
      descriptors.push_back(features.descriptor(i));
      descriptors.back()[random_() % 4] ^= 1ull << (random_() % 64);
    }
    return {from_seconds(at / kRate), std::make_shared<const Features>(mission_.rig.width, mission_.rig.height,
                                                                       keypoints, descriptors, std::vector<Patch>{})};
  }

  BodyMotion moved(int from, int to) const {
    const auto pose = [&](int i) { return mission_.truth[static_cast<std::size_t>(i)].world_from_body; };
    return inverse(pose(from)) * pose(to);
  }

  // Velocity of the camera between consecutive frames.
  CameraMotion velocity(int from, int to) const {
    const Pose change = true_camera_from_world(mission_, static_cast<std::size_t>(to)) *
                        inverse(true_camera_from_world(mission_, static_cast<std::size_t>(from)));
    return {kRate * log_pose(change), 3.0};
  }

  // Drives up to the freeze.
  void drive(bool has_wheels) {
    for (int i = 2; i <= kFreeze; ++i) {
      const auto wheels = has_wheels ? std::optional(moved(i - 1, i)) : std::nullopt;
      EXPECT_FALSE(watch_.note(with_noise(i, i), mission_.rig, wheels, velocity(i - 2, i - 1)).is_still) << i;
    }
  }

  SimulatedMission mission_ =
      simulate_mission(simulated_rig(), circling_trajectory(40, kRate, 2.0, 0.25), without_noise());
  StillImage watch_;
  std::mt19937 random_{1};
};

TEST_F(StillImageOnADrive, DetectsARepeatedImageByWheels) {
  drive(true);
  for (int i = kFreeze + 1; i < 40; ++i) {
    const Stillness found = watch_.note(with_noise(kFreeze, i), mission_.rig, moved(i - 1, i), {});
    EXPECT_TRUE(found.is_still);
    EXPECT_TRUE(found.is_frozen || i < kFreeze + 3) << i;
    EXPECT_NEAR(found.seconds, (i - kFreeze) / kRate, 1e-6);
  }
}

TEST_F(StillImageOnADrive, StaysFrozenWhileWheelsStopAfterwards) {
  drive(true);
  for (int i = kFreeze + 1; i < 40; ++i) watch_.note(with_noise(kFreeze, i), mission_.rig, moved(i - 1, i), {});
  for (int i = 40; i < 80; ++i) {
    EXPECT_TRUE(watch_.note(with_noise(kFreeze, i), mission_.rig, no_motion(), {}).is_frozen) << i;
  }
}

TEST_F(StillImageOnADrive, EndsOnceTheImageChanges) {
  drive(true);
  for (int i = kFreeze + 1; i < 30; ++i) watch_.note(with_noise(kFreeze, i), mission_.rig, moved(i - 1, i), {});
  for (int i = 30; i < 40; ++i) {
    const Stillness found = watch_.note(with_noise(i, i), mission_.rig, moved(i - 1, i), velocity(i - 2, i - 1));
    EXPECT_FALSE(found.is_still || found.is_frozen) << i;
  }
}

TEST_F(StillImageOnADrive, IsNotFrozenWhileWheelsStand) {
  drive(true);
  for (int i = kFreeze + 1; i < 200; ++i) {
    const Stillness found =
        watch_.note(with_noise(kFreeze, i), mission_.rig, no_motion(), velocity(kFreeze - 1, kFreeze));
    EXPECT_TRUE(found.is_still);
    EXPECT_FALSE(found.is_frozen) << i;
  }
}

TEST_F(StillImageOnADrive, DetectsARepeatedImageByASuddenStopWithoutWheels) {
  drive(false);
  for (int i = kFreeze + 1; i < 40; ++i) {
    const CameraMotion before = i == kFreeze + 1 ? velocity(kFreeze - 1, kFreeze) : CameraMotion{};
    const Stillness found = watch_.note(with_noise(kFreeze, i), mission_.rig, {}, before);
    EXPECT_TRUE(found.is_frozen || i < kFreeze + 3) << i;
  }
}

TEST_F(StillImageOnADrive, IsNotFrozenWhileTheRobotBrakesWithoutWheels) {
  drive(false);
  const Vector6 velocity_before = velocity(kFreeze - 2, kFreeze - 1).velocity;
  // The last frame before the stop moved by a quarter of the others.
  const auto braked = [&](int i) {
    return i == kFreeze + 1 ? CameraMotion{0.25 * velocity_before, 3.0} : CameraMotion{};
  };
  for (int i = kFreeze + 1; i < 100; ++i) {
    const Stillness found = watch_.note(with_noise(kFreeze, i), mission_.rig, {}, braked(i));
    EXPECT_TRUE(found.is_still);
    EXPECT_FALSE(found.is_frozen) << i;
  }
}

TEST_F(StillImageOnADrive, IsNotFrozenAtTheBeginning) {
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(watch_.note(with_noise(0, i), mission_.rig, {}, {}).is_frozen) << i;
  }
}

TEST_F(StillImageOnADrive, IgnoresAnUncertainMotion) {
  drive(true);
  for (int i = kFreeze + 1; i < 40; ++i) {
    BodyMotion vague = moved(i - 1, i);
    vague.covariance = Matrix6::Identity();
    EXPECT_FALSE(watch_.note(with_noise(kFreeze, i), mission_.rig, vague, {}).is_frozen) << i;
  }
}

}  // namespace
}  // namespace byre
