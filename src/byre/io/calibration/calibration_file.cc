#include "byre/calibration_file.h"

#include "byre/input_error.h"
#include "byre/io/calibration/camera_fields.h"

#include <limits>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

Calibration one_camera(const Camera& camera, const CalibrationFields& fields) {
  return {.left = camera,
          .right = std::nullopt,
          .body_from_left = fields.has("T_BS") ? fields.pose("T_BS") : Pose{},
          .readout_time = read_readout_time(fields, camera)};
}

Calibration kalibr_chain(const CalibrationFields& chain) {
  const CalibrationFields first = chain.group("cam0");
  Calibration calibration;
  calibration.left = read_camera_fields(first, "distortion_coeffs");
  calibration.readout_time = read_readout_time(first, calibration.left);
  if (first.has("T_cam_imu")) calibration.body_from_left = inverse(first.pose("T_cam_imu"));
  if (!chain.has("cam1")) return calibration;
  const CalibrationFields second = chain.group("cam1");
  calibration.right = StereoPartner{read_camera_fields(second, "distortion_coeffs"), second.pose("T_cn_cnm1")};
  require_baseline(*calibration.right, second.place("T_cn_cnm1"));
  return calibration;
}

void write_list(YAML::Emitter& yaml, const char* name, const std::vector<double>& values) {
  yaml << YAML::Key << name << YAML::Value << YAML::Flow << values;
}

const char* name_of_lens(CameraModel model) {
  switch (model) {
    case CameraModel::pinhole:
      return "none";
    case CameraModel::radial_tangential:
      return "radtan";
    case CameraModel::equidistant:
      return "equidistant";
  }
  return "";
}

void write_camera(YAML::Emitter& yaml, const Camera& camera) {
  yaml << YAML::Key << "camera_model" << YAML::Value << "pinhole";
  write_list(yaml, "intrinsics", {camera.fx, camera.fy, camera.cx, camera.cy});
  yaml << YAML::Key << "distortion_model" << YAML::Value << name_of_lens(camera.model);
  const bool has_fifth = camera.model == CameraModel::radial_tangential && camera.distortion[4] != 0.0;
  const auto end = camera.distortion.begin() + (has_fifth ? 5 : 4);
  write_list(yaml, "distortion_coeffs", std::vector<double>(camera.distortion.begin(), end));
  yaml << YAML::Key << "resolution" << YAML::Value << YAML::Flow << std::vector<int>{camera.width, camera.height};
}

void write_pose(YAML::Emitter& yaml, const char* name, const Pose& pose) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = pose.rotation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = pose.translation;
  yaml << YAML::Key << name << YAML::Value << YAML::BeginSeq;
  for (int row = 0; row < 4; ++row) {
    yaml << YAML::Flow << std::vector<double>{matrix(row, 0), matrix(row, 1), matrix(row, 2), matrix(row, 3)};
  }
  yaml << YAML::EndSeq;
}

Camera depth_lens(const CalibrationFields& fields) {
  if (fields.has("camera_matrix")) return read_opencv_camera(fields);
  return read_camera_fields(fields, fields.has("distortion_coeffs") ? "distortion_coeffs" : "distortion_coefficients");
}

constexpr const char* kDepthScale = "depth_scale";
constexpr const char* kDepthSigma = "depth_sigma";
constexpr const char* kDepthCamera = "depth_camera";

void write_depth_camera(YAML::Emitter& yaml, const DepthCamera& depth) {
  yaml << YAML::Key << kDepthScale << YAML::Value << depth.units_per_metre;
  yaml << YAML::Key << kDepthSigma << YAML::Value << depth.sigma_at_one_metre;
  if (!depth.camera) return;
  yaml << YAML::Key << kDepthCamera << YAML::Value << YAML::BeginMap;
  write_camera(yaml, *depth.camera);
  write_pose(yaml, "colour_from_depth", depth.left_from_depth);
  yaml << YAML::EndMap;
}

}  // namespace

Calibration read_calibration(const fs::path& path) {
  const CalibrationFields fields = CalibrationFields::load(path);
  if (fields.has("cam0")) return kalibr_chain(fields);
  if (fields.has("camera_matrix")) return one_camera(read_opencv_camera(fields), fields);
  if (fields.has("intrinsics")) return one_camera(read_camera_fields(fields, "distortion_coefficients"), fields);
  throw InputError(path.string(), "is not a supported calibration file",
                   "supported files have the field intrinsics (EuRoC sensor.yaml), camera_matrix (OpenCV, ROS) or cam0 "
                   "(Kalibr camchain)");
}

std::string write_calibration(const Calibration& calibration) {
  YAML::Emitter yaml;
  yaml.SetDoublePrecision(std::numeric_limits<double>::max_digits10);
  yaml << YAML::BeginMap << YAML::Key << "cam0" << YAML::Value << YAML::BeginMap;
  write_camera(yaml, calibration.left);
  write_pose(yaml, "T_cam_imu", inverse(calibration.body_from_left));
  if (calibration.readout_time != 0.0) yaml << YAML::Key << "readout_time" << YAML::Value << calibration.readout_time;
  yaml << YAML::EndMap;
  if (calibration.right) {
    yaml << YAML::Key << "cam1" << YAML::Value << YAML::BeginMap;
    write_camera(yaml, calibration.right->camera);
    write_pose(yaml, "T_cn_cnm1", calibration.right->right_from_left);
    yaml << YAML::EndMap;
  }
  if (calibration.depth) write_depth_camera(yaml, *calibration.depth);
  yaml << YAML::EndMap;
  return std::string(yaml.c_str()) + "\n";
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

bool has_depth_camera_fields(const fs::path& path) {
  const CalibrationFields fields = CalibrationFields::load(path);
  return fields.has(kDepthScale) || fields.has(kDepthSigma) || fields.has(kDepthCamera);
}

void require_baseline(const StereoPartner& partner, const std::string& place) {
  constexpr double kLeast = 1e-3;  // metres
  if (partner.right_from_left.translation.norm() >= kLeast) return;
  throw InputError(place, "places both cameras at the same position",
                   "calibrate the stereo pair, or use the left camera alone");
}

std::optional<fs::path> find_calibration(const fs::path& folder) {
  for (const char* const name : {"calibration.yaml", "camera.yaml", "sensor.yaml"}) {
    if (fs::is_regular_file(folder / name)) return folder / name;
  }
  return std::nullopt;
}

}  // namespace byre
