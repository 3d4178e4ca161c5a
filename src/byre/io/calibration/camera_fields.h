#pragma once

#include "byre/calibration.h"
#include "byre/io/calibration/calibration_fields.h"

#include <span>
#include <string>
#include <vector>

namespace byre {

// Camera of one file or group in the format of EuRoC or Kalibr: resolution, camera_model, intrinsics, distortion_model,
// and coefficients, whose field has another name in each. Throws InputError with the field for an unsupported model,
// and for missing or invalid values.
Camera read_camera_fields(const CalibrationFields& fields, const std::string& coefficients);

// Camera of a file written by OpenCV's calibration programs or ROS: image_width, image_height, camera_matrix and
// distortion_coefficients. Equidistant if distortion_model or fisheye_model specify it. Throws the same errors.
Camera read_opencv_camera(const CalibrationFields& fields);

// Sets focal lengths and principal point from a 3x3 matrix. Throws InputError for skew.
void set_camera_matrix(Camera& camera, const std::vector<double>& matrix, const std::string& place);

// The same with skew, which is left out, with a note, if it moves pixels by less than a quarter of a pixel.
void set_skewed_matrix(Camera& camera, std::vector<double> matrix, const std::string& place,
                       std::vector<std::string>& notes);

// Sets model and coefficients in OpenCV's order: four of a fisheye; else four to fourteen. Without distortion the model
// is pinhole. Throws InputError for another number of coefficients.
void set_opencv_distortion(Camera& camera, std::span<const double> coefficients, bool is_fisheye,
                           const std::string& place);

// A lens as Kalibr names it: the model of the projection with its intrinsics, and that of the distortion.
struct KalibrLens {
  std::string camera_model;
  std::vector<double> intrinsics;
  std::string distortion_model;
  std::vector<double> coefficients;
};

KalibrLens kalibr_lens(const Camera& camera);

// Sets model, intrinsics and coefficients. Names are those of Kalibr, EuRoC and aslam. place: field for InputError.
void set_kalibr_lens(Camera& camera, const KalibrLens& lens, const std::string& place);

// Readout time of a rolling shutter, seconds: readout_time, or rows times line_delay (Kalibr); zero without either.
// Throws InputError with the field for more than a second.
double read_readout_time(const CalibrationFields& fields, const Camera& camera);

// Throws InputError with the place for focal lengths that are not positive, shape parameters outside their domain, and
// a principal point outside the image, if its size is known.
void require_valid(const Camera& camera, const std::string& place);

}  // namespace byre
