#pragma once

#include "byre/geometry/camera.h"

#include <filesystem>
#include <optional>
#include <string>

namespace byre {

// The calibration of a camera or of a pair, in a YAML file by itself. It is told by its fields which it is:
//   EuRoC sensor.yaml  intrinsics, distortion_coefficients, T_BS (body from camera, identity where it is missing)
//   OpenCV, ROS        camera_matrix, distortion_coefficients, likewise with T_BS
//   Kalibr camchain    cam0 and perhaps cam1, with T_cn_cnm1 (this camera from the one before) and perhaps T_cam_imu,
//                      whose inverse is body from camera; cameras after the second are left out
// Throws InputError naming the field for a model that is not supported, and for what is missing or makes no sense.
Calibration read_calibration(const std::filesystem::path& path);

// The text of such a file, as Kalibr has it: read again, it gives the same calibration to the last digit but for
// rotations, which are rounded as matrices are.
std::string write_calibration(const Calibration& calibration);

// Throws InputError with this place when the cameras of a pair sit in one place, so that no depth can be seen.
void require_baseline(const StereoPartner& partner, const std::string& place);

// The calibration that lies in a folder: calibration.yaml, camera.yaml or sensor.yaml. Empty when there is none.
std::optional<std::filesystem::path> find_calibration(const std::filesystem::path& folder);

}  // namespace byre
