#pragma once

// Simulated missions for tests of tracking, mapping and sessions.

#include "byre/simulation/simulated_mission_scene.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace byre {

inline SimulationOptions without_noise() {
  SimulationOptions options;
  options.pixel_sigma = 0.0;
  options.disparity_sigma = 0.0;
  options.missing_ratio = 0.0;
  options.descriptor_flip_ratio = 0.0;
  return options;
}

// A quarter of a circle of 2 m radius; 8 cm and 2 degrees per frame.
inline SimulatedMission quarter_circle(const SimulationOptions& options) {
  return simulate_mission(simulated_rig(), circling_trajectory(40, 10.0, 2.0, 0.25), options);
}

inline Pose true_camera_from_world(const SimulatedMission& mission, std::size_t frame) {
  return inverse(mission.truth[frame].world_from_body * mission.rig.body_from_camera);
}

// Frame without the features at hidden pixels.
template <typename IsHidden>
Frame seen_beside(const Frame& frame, const Rig& rig, IsHidden is_hidden) {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  for (int i = 0; i < frame.features->size(); ++i) {
    if (is_hidden(frame.features->keypoint(i).pixel)) continue;
    keypoints.push_back(frame.features->keypoint(i));
    descriptors.push_back(frame.features->descriptor(i));
  }
  return {frame.time, std::make_shared<const Features>(rig.width, rig.height, std::move(keypoints),
                                                       std::move(descriptors), std::vector<Patch>{})};
}

// Index of the frame with a keyframe's time.
inline std::size_t frame_at(const SimulatedMission& mission, Timestamp time) {
  const auto found = std::ranges::find(mission.frames, time, &Frame::time);
  return static_cast<std::size_t>(found - mission.frames.begin());
}

// True landmark of a keyframe's feature; -1 for an outlier.
inline int true_landmark(const SimulatedMission& mission, const Keyframe& keyframe, int feature) {
  return mission.landmark_of_feature[frame_at(mission, keyframe.frame.time)][static_cast<std::size_t>(feature)];
}

// True landmark of most of a point's observations; -1 if that is an outlier.
inline int true_landmark(const SimulatedMission& mission, const MapGraph& map, PointId point) {
  std::vector<int> landmarks;
  for (const Observation& seen : map.observations(point)) {
    landmarks.push_back(true_landmark(mission, *map.find_keyframe(seen.keyframe), seen.feature));
  }
  std::ranges::sort(landmarks);
  return *std::ranges::max_element(landmarks, {}, [&](int one) { return std::ranges::count(landmarks, one); });
}

}  // namespace byre
