#pragma once

// Simulated missions with a rolling shutter.

#include "byre/features/rolling_shutter.h"
#include "byre/slam/tracking/mission_scene.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace byre {

// Velocity of the camera in the middle of a frame, per second.
inline Vector6 true_velocity(const SimulatedMission& mission, std::size_t frame) {
  const std::size_t before = frame == 0 ? 0 : frame - 1, after = std::min(frame + 1, mission.truth.size() - 1);
  const Pose motion = true_camera_from_world(mission, after) * inverse(true_camera_from_world(mission, before));
  return log_pose(motion) / to_seconds(mission.truth[after].time - mission.truth[before].time);
}

// The corner at the readout time of its row, which depends on its position.
inline Keypoint read_late(Keypoint keypoint, const Eigen::Vector3d& point_in_camera, const Rig& rig,
                          const Vector6& velocity, double readout_time) {
  const StereoPixel at_once = rig.project(point_in_camera);
  StereoPixel rolled = at_once;
  for (int i = 0; i < 5; ++i) {
    keypoint.row_time = static_cast<float>((rolled.y() + 0.5) / rig.height - 0.5);
    rolled = rig.project(exp_pose(velocity * (readout_time * keypoint.row_time)) * point_in_camera);
  }
  keypoint.pixel += (rolled - at_once).head<2>().cast<float>();
  if (keypoint.has_disparity()) keypoint.disparity += static_cast<float>(rolled.z() - at_once.z());
  return keypoint;
}

// The same mission with a readout time, seconds.
inline SimulatedMission rolling(SimulatedMission mission, double readout_time) {
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    const Vector6 velocity = true_velocity(mission, i);
    std::vector<Keypoint> keypoints = to_vector(mission.frames[i].features->keypoints());
    for (std::size_t k = 0; k < keypoints.size(); ++k) {
      const int landmark = mission.landmark_of_feature[i][k];
      if (landmark < 0) continue;
      const Eigen::Vector3d point =
          true_camera_from_world(mission, i) * mission.landmarks_in_world[static_cast<std::size_t>(landmark)];
      keypoints[k] = read_late(keypoints[k], point, mission.rig, velocity, readout_time);
    }
    mission.frames[i].features =
        std::make_shared<const Features>(mission.frames[i].features->moved(std::move(keypoints)));
  }
  return mission;
}

}  // namespace byre
