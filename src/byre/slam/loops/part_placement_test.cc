#include "byre/slam/loops/global_mapping.h"

#include "byre/alignment.h"
#include "byre/slam/tracking/body_pose.h"
#include "byre/slam/tracking/mission_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

// A true monocular map in two parts without common points. Tests displace and scale the second part, and add measured
// motions between keyframes.
class TwoParts : public ::testing::Test {
 protected:
  TwoParts() {
    const MapGraph map = true_map(mission_, 4, Origin::online);
    truth_ = window_of(map, map.keyframe_ids());
    for (WindowKeyframe& keyframe : truth_.keyframes) keyframe.movable = &keyframe != &truth_.keyframes.front();
    for (WindowPoint& point : truth_.points) {
      if (point.observations.empty()) continue;
      const bool first = is_of_first(point.observations.front().keyframe);
      const auto seen = point.observations;
      for (const WindowObservation& observation : seen) {
        if (is_of_first(observation.keyframe) != first) remove_observation(truth_, observation);
      }
    }
  }

  bool is_of_first(int keyframe) const { return keyframe < static_cast<int>(truth_.keyframes.size()) / 2; }

  MapWindow moved(const Similarity& wrong) const {
    MapWindow window = truth_;
    for (std::size_t i = 0; i < window.keyframes.size(); ++i) {
      Pose& pose = window.keyframes[i].keyframe.camera_from_world;
      if (!is_of_first(static_cast<int>(i))) pose = move_camera(wrong, pose);
    }
    for (WindowPoint& point : window.points) {
      if (point.observations.empty() || is_of_first(point.observations.front().keyframe)) continue;
      point.point.position_in_world = wrong * point.point.position_in_world;
    }
    return window;
  }

  // Adds measured motions between successive keyframes, with scaled lengths.
  void tell(MapWindow& window, double lengths = 1.0) const {
    for (std::size_t i = 1; i < truth_.keyframes.size(); ++i) {
      const Pose motion = inverse(body(truth_, i - 1)) * body(truth_, i);
      const int later = static_cast<int>(i);
      window.motions.push_back({later - 1, later, {scale_lengths(motion, lengths), 1e-4 * Matrix6::Identity()}});
    }
  }

  void expect_truth(const MapWindow& window) const {
    for (std::size_t i = 0; i < window.keyframes.size(); ++i) {
      const Pose error = inverse(body(truth_, i)) * body(window, i);
      EXPECT_LT(log_pose(error).norm(), 1e-6) << i;
    }
    for (std::size_t i = 0; i < window.points.size(); ++i) {
      if (window.points[i].observations.empty()) continue;
      EXPECT_LT((window.points[i].point.position_in_world - truth_.points[i].point.position_in_world).norm(), 1e-6);
    }
  }

  static Pose body(const MapWindow& window, std::size_t keyframe) {
    const WindowKeyframe& entry = window.keyframes[keyframe];
    return body_pose(window.rig_of(entry), entry.keyframe.camera_from_world);
  }

  static Rig one_camera() {
    Rig rig = simulated_rig();
    rig.baseline = 0.0;
    return rig;
  }

  const SimulatedMission mission_ = simulate_mission(one_camera(), circling_trajectory(60, 10.0, 2.0, 0.4), {});
  MapWindow truth_;
  const Similarity wrong_{1.3, {rotation_exp({0.1, -0.4, 0.05}), {2.0, -1.0, 0.3}}};
};

TEST_F(TwoParts, ArePlacedByMeasuredMotion) {
  MapWindow window = moved(wrong_);
  tell(window);
  EXPECT_TRUE(place_parts(window));
  expect_truth(window);
}

// Measured motions are 5 % too long.
TEST_F(TwoParts, TakeTheScaleOfTheFirst) {
  MapWindow window = moved(wrong_);
  tell(window, 1.05);
  EXPECT_TRUE(place_parts(window));
  expect_truth(window);
  const Pose motion = inverse(body(truth_, 0)) * body(truth_, 1);
  EXPECT_LT((window.motions.front().motion.last_from_body.translation - motion.translation).norm(), 1e-6);
}

TEST_F(TwoParts, StayWithoutMeasuredMotionBetweenThem) {
  MapWindow window = moved(wrong_);
  tell(window);
  std::erase_if(window.motions,
                [&](const WindowMotion& motion) { return is_of_first(motion.earlier) != is_of_first(motion.later); });
  const MapWindow before = window;
  EXPECT_FALSE(place_parts(window));
  EXPECT_EQ(window.keyframes.back().keyframe.camera_from_world.translation,
            before.keyframes.back().keyframe.camera_from_world.translation);
}

TEST_F(TwoParts, StayIfFixed) {
  MapWindow window = moved(wrong_);
  window.keyframes.back().movable = false;
  const Pose before = window.keyframes.back().keyframe.camera_from_world;
  tell(window);
  place_parts(window);
  EXPECT_EQ(window.keyframes.back().keyframe.camera_from_world.translation, before.translation);
}

}  // namespace
}  // namespace byre
