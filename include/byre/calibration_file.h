#pragma once

#include "byre/calibration.h"

#include <filesystem>
#include <optional>
#include <string>

namespace byre {

// Reads the calibration of one camera or a stereo pair from a YAML file. The fields determine the format:
//   EuRoC sensor.yaml  intrinsics, distortion_coefficients, T_BS (body from camera, default identity)
//   OpenCV, ROS        camera_matrix, distortion_coefficients, T_BS as above
//   Kalibr camchain    cam0 and optionally cam1, with T_cn_cnm1 (this camera from the previous one) and optionally
//                      T_cam_imu, whose inverse is body from camera; further cameras are ignored
// Optional per camera, read from the first of a chain: readout_time or Kalibr's line_delay, seconds for all rows or one
// row. Throws InputError with the field for an unsupported model and for a missing or invalid value.
Calibration read_calibration(const std::filesystem::path& path);

// Text of a Kalibr camchain. Reading it back yields the same calibration bit by bit, except for the rounding of
// rotation matrices.
std::string write_calibration(const Calibration& calibration);

// Reads a depth camera from fields of a calibration file, which may also stand alone:
//   depth_scale   units of the depth images per metre; default 5000, as in TUM
//   depth_sigma   standard deviation of a depth of one metre, metres; grows with the square of depth
//   depth_camera  only if depth images are not registered to the colour camera: intrinsics in any format for one
//                 camera, and colour_from_depth, the 4x4 matrix of its pose in the colour camera
// Throws InputError with the field for an invalid value.
DepthCamera read_depth_camera(const std::filesystem::path& path);

// Whether the file has any field of a depth camera. Throws InputError if it cannot be read.
bool has_depth_camera_fields(const std::filesystem::path& path);

// Throws InputError with this place if the baseline of the pair is zero, as depth is then unobservable.
void require_baseline(const StereoPartner& partner, const std::string& place);

// Calibration file in a folder: calibration.yaml, camera.yaml or sensor.yaml. Empty if there is none.
std::optional<std::filesystem::path> find_calibration(const std::filesystem::path& folder);

}  // namespace byre
