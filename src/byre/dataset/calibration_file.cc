#include "byre/dataset/calibration_file.h"

#include "byre/dataset/camera_fields.h"
#include "byre/input/input_error.h"

namespace byre {
namespace {

namespace fs = std::filesystem;

Calibration one_camera(const Camera& camera, const CalibrationFields& fields) {
  return {camera, std::nullopt, fields.has("T_BS") ? fields.pose("T_BS") : Pose{}};
}

Calibration kalibr_chain(const CalibrationFields& chain) {
  const CalibrationFields first = chain.group("cam0");
  Calibration calibration;
  calibration.left = read_camera_fields(first, "distortion_coeffs");
  if (first.has("T_cam_imu")) calibration.body_from_left = inverse(first.pose("T_cam_imu"));
  if (!chain.has("cam1")) return calibration;
  const CalibrationFields second = chain.group("cam1");
  calibration.right = StereoPartner{read_camera_fields(second, "distortion_coeffs"), second.pose("T_cn_cnm1")};
  require_baseline(*calibration.right, second.place("T_cn_cnm1"));
  return calibration;
}

Camera depth_lens(const CalibrationFields& fields) {
  if (fields.has("camera_matrix")) return read_opencv_camera(fields);
  return read_camera_fields(fields, fields.has("distortion_coeffs") ? "distortion_coeffs" : "distortion_coefficients");
}

constexpr const char* kDepthScale = "depth_scale";
constexpr const char* kDepthSigma = "depth_sigma";
constexpr const char* kDepthCamera = "depth_camera";

}  // namespace

Calibration read_calibration(const fs::path& path) {
  const CalibrationFields fields = CalibrationFields::load(path);
  if (fields.has("cam0")) return kalibr_chain(fields);
  if (fields.has("camera_matrix")) return one_camera(read_opencv_camera(fields), fields);
  if (fields.has("intrinsics")) return one_camera(read_camera_fields(fields, "distortion_coefficients"), fields);
  throw InputError(path.string(), "is no calibration that byre knows",
                   "looked for intrinsics (EuRoC sensor.yaml), camera_matrix (OpenCV, ROS) and cam0 (Kalibr camchain)");
}

DepthCamera read_depth_camera(const fs::path& path) {
  const CalibrationFields fields = CalibrationFields::load(path);
  DepthCamera depth;
  if (fields.has(kDepthScale)) depth.units_per_metre = fields.positive(kDepthScale);
  if (fields.has(kDepthSigma)) depth.sigma_at_one_metre = fields.positive(kDepthSigma);
  if (!fields.has(kDepthCamera)) return depth;
  const CalibrationFields own = fields.group(kDepthCamera);
  depth.camera = depth_lens(own);
  depth.left_from_depth = own.pose("colour_from_depth");
  return depth;
}

bool names_depth_camera(const fs::path& path) {
  const CalibrationFields fields = CalibrationFields::load(path);
  return fields.has(kDepthScale) || fields.has(kDepthSigma) || fields.has(kDepthCamera);
}

void require_baseline(const StereoPartner& partner, const std::string& place) {
  constexpr double kLeast = 1e-3;  // metres
  if (partner.right_from_left.translation.norm() >= kLeast) return;
  throw InputError(place, "puts both cameras in the same place",
                   "calibrate the stereo pair, or take the left camera alone");
}

std::optional<fs::path> find_calibration(const fs::path& folder) {
  for (const char* const name : {"calibration.yaml", "camera.yaml", "sensor.yaml"}) {
    if (fs::is_regular_file(folder / name)) return folder / name;
  }
  return std::nullopt;
}

}  // namespace byre
