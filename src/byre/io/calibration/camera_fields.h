#pragma once

#include "byre/calibration.h"
#include "byre/io/calibration/calibration_fields.h"

#include <string>

namespace byre {

// Camera of one file or group in the format of EuRoC or Kalibr: resolution, camera_model, intrinsics, distortion_model,
// and coefficients, whose field has another name in each. Throws InputError with the field for an unsupported model,
// and for missing or invalid values.
Camera read_camera_fields(const CalibrationFields& fields, const std::string& coefficients);

// Camera of a file written by OpenCV's calibration programs or ROS: image_width, image_height, camera_matrix and
// distortion_coefficients. Equidistant if distortion_model or fisheye_model specify it. Throws the same errors.
Camera read_opencv_camera(const CalibrationFields& fields);

// Readout time of a rolling shutter, seconds: readout_time, or rows times line_delay (Kalibr); zero without either.
// Throws InputError with the field for more than a second.
double read_readout_time(const CalibrationFields& fields, const Camera& camera);

// Throws InputError with the place for focal lengths that are not positive, and a principal point outside the image.
void require_valid(const Camera& camera, const std::string& place);

}  // namespace byre
