#pragma once

#include "byre/calibration.h"

#include <filesystem>
#include <optional>
#include <string>

namespace byre {

// The calibration of a camera or of a pair, in a YAML file by itself. It is told by its fields which it is:
//   EuRoC sensor.yaml  intrinsics, distortion_coefficients, T_BS (body from camera, identity where it is missing)
//   OpenCV, ROS        camera_matrix, distortion_coefficients, likewise with T_BS
//   Kalibr camchain    cam0 and perhaps cam1, with T_cn_cnm1 (this camera from the one before) and perhaps T_cam_imu,
//                      whose inverse is body from camera; cameras after the second are left out
// Each camera (the first of a chain) may tell its rolling shutter: readout_time, or line_delay as Kalibr has it;
// seconds, of all rows and of one. Throws InputError naming the field for a model that is not supported, and for what
// is missing or makes no sense.
Calibration read_calibration(const std::filesystem::path& path);

// The text of such a file, as Kalibr has it: read again, it gives the same calibration to the last digit but for
// rotations, which are rounded as matrices are.
std::string write_calibration(const Calibration& calibration);

// What such a file says of a depth camera, in fields of its own beside the others (or by themselves):
//   depth_scale   units per metre of the numbers in its images; 5000 where it is missing, as in TUM's
//   depth_sigma   metres, of a depth of one metre; it grows with the square of depth
//   depth_camera  where its images are not registered to the colour camera's: its own lens, described as above in any
//                 of the ways for one camera, and colour_from_depth, the 4x4 matrix of its pose in the colour camera
// Throws InputError naming the field for what makes no sense.
DepthCamera read_depth_camera(const std::filesystem::path& path);

// Whether the file has any of these fields. Throws InputError when it cannot be read.
bool names_depth_camera(const std::filesystem::path& path);

// Throws InputError with this place when the cameras of a pair sit in one place, so that no depth can be seen.
void require_baseline(const StereoPartner& partner, const std::string& place);

// The calibration that lies in a folder: calibration.yaml, camera.yaml or sensor.yaml. Empty when there is none.
std::optional<std::filesystem::path> find_calibration(const std::filesystem::path& folder);

}  // namespace byre
