#include "byre/simulation/simulated_trajectory_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace byre {
namespace {

constexpr double kFullTurn = 2.0 * std::numbers::pi;

// forward_from_camera: camera axes x right, y down, z forward to x forward, y left, z up.
Eigen::Quaterniond forward_from_camera() {
  Eigen::Matrix3d axes;
  axes << 0.0, 0.0, 1.0,  //
      -1.0, 0.0, 0.0,     //
      0.0, -1.0, 0.0;
  return Eigen::Quaterniond(axes);
}

// heading: radians to the left of the world's x axis; lean: roll to the camera's right, radians.
Pose world_from_camera(const Eigen::Vector3d& position, double heading, double lean) {
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

}  // namespace

Rig simulated_rig(const Pose& body_from_camera) {
  return {.width = 752,
          .height = 480,
          .focal = 435.0,
          .cx = 375.5,
          .cy = 239.5,
          .baseline = 0.11,
          .body_from_camera = body_from_camera};
}

Pose robot_from_camera() {
  return {forward_from_camera(), {0.2, 0.0, 0.3}};
}

Trajectory circling_trajectory(int frames, double frame_rate_hz, double radius_m, double laps,
                               const Pose& body_from_camera) {
  return sample(frames, frame_rate_hz, body_from_camera, [&](double done) {
    const double angle = kFullTurn * laps * done;
    const Eigen::Vector3d position(radius_m * std::cos(angle), radius_m * std::sin(angle), 0.0);
    return world_from_camera(position, angle + kFullTurn / 4.0, 0.0);
  });
}

Trajectory turning_in_place_trajectory(int frames, double frame_rate_hz, double turns, const Pose& body_from_camera) {
  return sample(frames, frame_rate_hz, body_from_camera,
                [&](double done) { return world_from_camera(Eigen::Vector3d::Zero(), kFullTurn * turns * done, 0.0); });
}

Trajectory figure_eight_trajectory(int frames, double frame_rate_hz, double length_m, double laps,
                                   const Pose& body_from_camera) {
  constexpr double kRise = 0.15;  // metres
  constexpr double kLean = 0.15;  // radians
  return sample(frames, frame_rate_hz, body_from_camera, [&](double done) {
    const double phase = kFullTurn * laps * done;
    const Eigen::Vector3d position(0.5 * length_m * std::sin(phase), 0.25 * length_m * std::sin(2.0 * phase),
                                   kRise * std::sin(3.0 * phase));
    const double heading = std::atan2(std::cos(2.0 * phase), std::cos(phase));
    return world_from_camera(position, heading, kLean * std::sin(phase));
  });
}

}  // namespace byre
