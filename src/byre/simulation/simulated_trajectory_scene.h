#pragma once

#include "byre/rig.h"
#include "byre/trajectory.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace byre {

// Smooth trajectories about the centre of a room, the world's origin; z up. The camera looks along the path, level,
// with its x axis to the right. body_from_camera is the pose of that camera on the body; identity: the body is the
// camera.

// A stereo rig like EuRoC's: 752 x 480 pixels, 82 degrees horizontal field of view, baseline 0.11 m.
Rig simulated_rig(const Pose& body_from_camera = {});

// Camera on a robot body with x forward, y left, z up: looks forward, ahead of and above the body's origin.
Pose robot_from_camera();

// Counter-clockwise circle at constant height, looking along it; whole laps end at the start.
Trajectory circling_trajectory(int frames, double frame_rate_hz, double radius_m, double laps,
                               const Pose& body_from_camera = {});

Trajectory turning_in_place_trajectory(int frames, double frame_rate_hz, double turns,
                                       const Pose& body_from_camera = {});

// A figure of eight, length_m long and half as wide. It rises, falls and leans into its bends, so that all six degrees
// of freedom vary.
Trajectory figure_eight_trajectory(int frames, double frame_rate_hz, double length_m, double laps,
                                   const Pose& body_from_camera = {});
// Helpers of the functions above.
namespace simulated {

inline constexpr double kFullTurn = 2.0 * std::numbers::pi;

// forward_from_camera: camera axes x right, y down, z forward to x forward, y left, z up.
inline Eigen::Quaterniond forward_from_camera() {
  Eigen::Matrix3d axes;
  axes << 0.0, 0.0, 1.0,  //
      -1.0, 0.0, 0.0,     //
      0.0, -1.0, 0.0;
  return Eigen::Quaterniond(axes);
}

// heading: radians to the left of the world's x axis; lean: roll to the camera's right, radians.
inline Pose world_from_camera(const Eigen::Vector3d& position, double heading, double lean) {
  const Eigen::Quaterniond world_from_forward = rotation_exp({0.0, 0.0, heading}) * rotation_exp({lean, 0.0, 0.0});
  return {world_from_forward * forward_from_camera(), position};
}

// world_from_camera_at: callable of progress, 0 to 1.
template <typename WorldFromCameraAt>
Trajectory sample(int frames, double frame_rate_hz, const Pose& body_from_camera,
                  WorldFromCameraAt world_from_camera_at) {
  const Pose camera_from_body = inverse(body_from_camera);
  Trajectory trajectory;
  trajectory.reserve(static_cast<std::size_t>(frames));
  for (int i = 0; i < frames; ++i) {
    const double done = static_cast<double>(i) / std::max(frames - 1, 1);
    trajectory.push_back({from_seconds(i / frame_rate_hz), world_from_camera_at(done) * camera_from_body});
  }
  return trajectory;
}

}  // namespace simulated

inline Rig simulated_rig(const Pose& body_from_camera) {
  return {.width = 752,
          .height = 480,
          .focal = 435.0,
          .cx = 375.5,
          .cy = 239.5,
          .baseline = 0.11,
          .body_from_camera = body_from_camera};
}

inline Pose robot_from_camera() {
  return {simulated::forward_from_camera(), {0.2, 0.0, 0.3}};
}

inline Trajectory circling_trajectory(int frames, double frame_rate_hz, double radius_m, double laps,
                                      const Pose& body_from_camera) {
  return simulated::sample(frames, frame_rate_hz, body_from_camera, [&](double done) {
    const double angle = simulated::kFullTurn * laps * done;
    const Eigen::Vector3d position(radius_m * std::cos(angle), radius_m * std::sin(angle), 0.0);
    return simulated::world_from_camera(position, angle + simulated::kFullTurn / 4.0, 0.0);
  });
}

inline Trajectory turning_in_place_trajectory(int frames, double frame_rate_hz, double turns,
                                              const Pose& body_from_camera) {
  return simulated::sample(frames, frame_rate_hz, body_from_camera, [&](double done) {
    return simulated::world_from_camera(Eigen::Vector3d::Zero(), simulated::kFullTurn * turns * done, 0.0);
  });
}

inline Trajectory figure_eight_trajectory(int frames, double frame_rate_hz, double length_m, double laps,
                                          const Pose& body_from_camera) {
  constexpr double kRise = 0.15;  // metres
  constexpr double kLean = 0.15;  // radians
  return simulated::sample(frames, frame_rate_hz, body_from_camera, [&](double done) {
    const double phase = simulated::kFullTurn * laps * done;
    const Eigen::Vector3d position(0.5 * length_m * std::sin(phase), 0.25 * length_m * std::sin(2.0 * phase),
                                   kRise * std::sin(3.0 * phase));
    const double heading = std::atan2(std::cos(2.0 * phase), std::cos(phase));
    return simulated::world_from_camera(position, heading, kLean * std::sin(phase));
  });
}

}  // namespace byre
