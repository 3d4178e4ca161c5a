#include "byre/io/calibration/camera_fields.h"

#include "byre/base/text_file.h"
#include "byre/input_error.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace byre {
namespace {

[[noreturn]] void refuse_model(const std::string& place, const std::string& model) {
  throw InputError(
      place, "\"" + model + "\" is not supported",
      "supported models: pinhole with radial-tangential (radtan), equidistant (fisheye) or no "
      "distortion (none); calibrate with one of these, in Kalibr with --models pinhole-radtan or pinhole-equi");
}

CameraModel parse_lens_model(const CalibrationFields& fields) {
  const std::string distortion = fields.text("distortion_model");
  if (distortion == "radial-tangential" || distortion == "radtan") return CameraModel::radial_tangential;
  if (distortion == "equidistant") return CameraModel::equidistant;
  if (distortion == "none") return CameraModel::pinhole;
  refuse_model(fields.place("distortion_model"), distortion);
}

CameraModel read_model(const CalibrationFields& fields) {
  if (const std::string model = fields.text("camera_model"); model != "pinhole") {
    refuse_model(fields.place("camera_model"), model);
  }
  return parse_lens_model(fields);
}

void read_resolution(const CalibrationFields& fields, Camera& camera) {
  const std::vector<double> resolution = fields.numbers("resolution", 2);
  camera.width = to_image_side(resolution[0], fields.place("resolution"));
  camera.height = to_image_side(resolution[1], fields.place("resolution"));
}

void read_intrinsics(const CalibrationFields& fields, Camera& camera) {
  const std::vector<double> intrinsics = fields.numbers("intrinsics", 4);
  camera.fx = intrinsics[0];
  camera.fy = intrinsics[1];
  camera.cx = intrinsics[2];
  camera.cy = intrinsics[3];
  require_valid(camera, fields.place("intrinsics"));
}

// Precondition: the lens has distortion.
void read_distortion(const CalibrationFields& fields, const std::string& name, Camera& camera) {
  const std::vector<double> coefficients = fields.numbers(name);
  const bool has_k3 = camera.model == CameraModel::radial_tangential && coefficients.size() == 5;
  if (!has_k3) fields.numbers(name, 4);
  std::copy(coefficients.begin(), coefficients.end(), camera.distortion.begin());
}

// Model names of OpenCV's programs and ROS; without a name, the lens of cv::calibrateCamera.
CameraModel read_opencv_model(const CalibrationFields& fields) {
  if (fields.has("distortion_model")) {
    const std::string distortion = fields.text("distortion_model");
    if (distortion == "plumb_bob" || distortion == "rational_polynomial") return CameraModel::radial_tangential;
    if (distortion == "fisheye") return CameraModel::equidistant;
    return parse_lens_model(fields);
  }
  const bool is_fisheye = fields.has("fisheye_model") && fields.text("fisheye_model") != "0";
  return is_fisheye ? CameraModel::equidistant : CameraModel::radial_tangential;
}

void read_camera_matrix(const CalibrationFields& fields, Camera& camera) {
  const std::vector<double> matrix = fields.numbers("camera_matrix", 9);
  const std::string place = fields.place("camera_matrix");
  const bool is_pinhole = matrix[1] == 0.0 && matrix[3] == 0.0 && matrix[6] == 0.0 && matrix[7] == 0.0;
  if (!is_pinhole || matrix[8] != 1.0) {
    throw InputError(place, "is not of the form fx 0 cx, 0 fy cy, 0 0 1", "calibrate without skew");
  }
  camera.fx = matrix[0];
  camera.cx = matrix[2];
  camera.fy = matrix[4];
  camera.cy = matrix[5];
  require_valid(camera, place);
}

// OpenCV's longer lists continue with k4 to k6 of the rational model, thin prisms and a tilt, which are not supported.
void read_opencv_distortion(const CalibrationFields& fields, Camera& camera) {
  if (camera.model == CameraModel::equidistant) return read_distortion(fields, "distortion_coefficients", camera);
  const std::vector<double> coefficients = fields.numbers("distortion_coefficients");
  const std::string place = fields.place("distortion_coefficients");
  if (!coefficients.empty() && coefficients.size() < 4) fields.numbers("distortion_coefficients", 4);
  const auto known = coefficients.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(coefficients.size(), 5));
  const auto is_zero = [](double value) { return value == 0.0; };
  if (!std::all_of(known, coefficients.end(), is_zero)) {
    throw InputError(place, "has coefficients other than zero after k1, k2, p1, p2 and k3",
                     "the rational model is not supported; calibrate with at most five coefficients, or as a fisheye");
  }
  std::copy(coefficients.begin(), known, camera.distortion.begin());
  if (std::all_of(coefficients.begin(), known, is_zero)) camera.model = CameraModel::pinhole;
}

}  // namespace

void require_valid(const Camera& camera, const std::string& place) {
  if (!(camera.fx > 0.0) || !(camera.fy > 0.0)) throw InputError(place, "the focal lengths must be positive");
  if (camera.contains({camera.cx, camera.cy})) return;
  throw InputError(place, "the principal point is outside the image",
                   "check that the intrinsics belong to this resolution");
}

Camera read_camera_fields(const CalibrationFields& fields, const std::string& coefficients) {
  Camera camera;
  camera.model = read_model(fields);
  read_resolution(fields, camera);
  read_intrinsics(fields, camera);
  if (camera.model != CameraModel::pinhole) read_distortion(fields, coefficients, camera);
  return camera;
}

Camera read_opencv_camera(const CalibrationFields& fields) {
  Camera camera;
  camera.model = read_opencv_model(fields);
  camera.width = fields.pixels("image_width");
  camera.height = fields.pixels("image_height");
  read_camera_matrix(fields, camera);
  if (camera.model != CameraModel::pinhole) read_opencv_distortion(fields, camera);
  return camera;
}

double read_readout_time(const CalibrationFields& fields, const Camera& camera) {
  constexpr double kLongest = 1.0;  // seconds
  for (const auto& [field, unit] : {std::pair("readout_time", 1.0), std::pair("line_delay", 1.0 * camera.height)}) {
    if (!fields.has(field)) continue;
    const std::optional<double> number = parse_number(fields.text(field));
    if (number && std::abs(*number * unit) <= kLongest) return *number * unit;
    throw InputError(fields.place(field), "is not a valid readout time",
                     "give seconds: line_delay per row, or readout_time for all rows");
  }
  return 0.0;
}

}  // namespace byre
