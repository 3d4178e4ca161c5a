#pragma once

#include "byre/calibration.h"
#include "byre/dataset/calibration_fields.h"

#include <string>

namespace byre {

// The camera of one file or group, as EuRoC and Kalibr describe it: resolution, camera_model, intrinsics,
// distortion_model, and coefficients in a field that each calls its own way. Throws InputError, naming the field, for a
// model that byre does not know, and for what is missing or makes no sense.
Camera read_camera_fields(const CalibrationFields& fields, const std::string& coefficients);

// The camera of a file as OpenCV's calibration programs and ROS write it: image_width, image_height, camera_matrix and
// distortion_coefficients, an equidistant lens where distortion_model or fisheye_model says so. Throws likewise.
Camera read_opencv_camera(const CalibrationFields& fields);

// How long a rolling shutter takes to read an image, seconds: readout_time, or rows times line_delay as Kalibr has it;
// zero where neither is told. Throws InputError, naming the field, for more than a second.
double read_readout_time(const CalibrationFields& fields, const Camera& camera);

// Throws InputError, naming the place, for focal lengths that are not positive or a principal point outside the image.
void require_sense(const Camera& camera, const std::string& place);

}  // namespace byre
