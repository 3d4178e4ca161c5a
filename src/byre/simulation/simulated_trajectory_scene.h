#pragma once

#include "byre/rig.h"
#include "byre/trajectory.h"

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

}  // namespace byre
