#include "byre/calibration_file.h"

#include "byre/base/text_file.h"
#include "byre/io/calibration/calibration_formats.h"
#include "byre/io/calibration/camera_fields.h"
#include "byre/io/calibration/format_readers.h"

#include <array>
#include <limits>
#include <string_view>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLeaveRightOut =
    "give the pose of the right camera: R and T in a second file, or a Kalibr camchain";

Pose pose_of_right(const CameraList& list) {
  const PlacedCamera& left = list.cameras[0];
  const PlacedCamera& right = list.cameras[1];
  if (right.from_previous) return *right.from_previous;
  if (left.rectified && right.rectified) {
    if (const auto pose = right_from_left(*left.rectified, *right.rectified)) return *pose;
  }
  if (left.body_from_camera && right.body_from_camera) {
    return inverse(*right.body_from_camera) * *left.body_from_camera;
  }
  if (left.rectified && right.rectified) {
    throw InputError(right.pose_place, "has no baseline, or a rotation matrix of the pair is not a rotation",
                     "calibrate both cameras as a stereo pair");
  }
  throw InputError(right.pose_place, "is missing", kLeaveRightOut);
}

std::vector<std::string> names_of(const CameraList& list) {
  return list.names.empty() ? std::vector<std::string>{"left", "right"} : list.names;
}

bool has_place_of_pose(const CameraList& list) {
  const PlacedCamera& right = list.cameras[1];
  return !right.pose_place.empty() || right.from_previous || right.rectified || right.body_from_camera;
}

CalibrationReading combined(CameraList list, const fs::path& path) {
  if (list.cameras.size() > 2 || (list.cameras.size() == 2 && !has_place_of_pose(list))) {
    const std::vector<std::string> names = names_of(list);
    throw InputError(path.string(),
                     fmt::format("has {} cameras: {}, without relative poses", names.size(), fmt::join(names, ", ")),
                     list.cameras.size() > 2 ? "give a file of one camera or of a stereo pair" : kLeaveRightOut);
  }
  const PlacedCamera& left = list.cameras.front();
  CalibrationReading reading{{.left = left.camera,
                              .right = std::nullopt,
                              .body_from_left = left.body_from_camera.value_or(Pose{}),
                              .readout_time = left.readout_time},
                             std::move(list.format),
                             std::move(list.notes)};
  if (list.cameras.size() > 1) {
    reading.calibration.right = StereoPartner{list.cameras[1].camera, pose_of_right(list)};
    require_baseline(*reading.calibration.right, list.cameras[1].pose_place);
  } else if (left.rectified && left.rectified->projection(0, 3) != 0.0) {
    reading.notes.push_back("a camera of a stereo pair; give the files of both cameras for the pair");
  }
  return reading;
}

CalibrationReading read_one(const fs::path& path, std::optional<std::pair<int, int>> size = std::nullopt) {
  CameraList list = read_cameras(path, size);
  const std::vector<std::string> names = names_of(list);
  try {
    return combined(std::move(list), path);
  } catch (const InputError& fault) {
    throw UnplacedCameras(fault, path, names);
  }
}

// Names of files of a pair in a folder.
std::optional<std::pair<fs::path, fs::path>> pair_in(const fs::path& folder) {
  for (const auto& [left, right] : {std::pair("left", "right"), std::pair("intrinsics", "extrinsics"),
                                    std::pair("cam0", "cam1"), std::pair("camera_left", "camera_right")}) {
    for (const char* const extension : {".yaml", ".yml", ".ini", ".xml"}) {
      std::pair<fs::path, fs::path> files{folder / (std::string(left) + extension),
                                          folder / (std::string(right) + extension)};
      if (fs::is_regular_file(files.first) && fs::is_regular_file(files.second)) return files;
    }
  }
  return std::nullopt;
}

CalibrationReading read_pair(const fs::path& left, const fs::path& right) {
  if (const auto extrinsics = read_opencv_extrinsics(right)) {
    CameraList list = read_cameras(left);
    if (list.cameras.size() == 2) {
      list.cameras[1].from_previous = extrinsics;
      return combined(std::move(list), left);
    }
  }
  CameraList list = read_cameras(left);
  const CameraList second = read_cameras(right);
  if (list.cameras.size() > 1 || second.cameras.size() > 1) {
    throw InputError(list.cameras.size() > 1 ? left.string() : right.string(), "already has both cameras",
                     "give this file alone");
  }
  list.cameras.push_back(second.cameras.front());
  list.notes.insert(list.notes.end(), second.notes.begin(), second.notes.end());
  return combined(std::move(list), left);
}

void write_list(YAML::Emitter& yaml, const char* name, const std::vector<double>& values) {
  yaml << YAML::Key << name << YAML::Value << YAML::Flow << values;
}

void write_camera(YAML::Emitter& yaml, const Camera& camera) {
  const KalibrLens lens = kalibr_lens(camera);
  yaml << YAML::Key << "camera_model" << YAML::Value << lens.camera_model;
  write_list(yaml, "intrinsics", lens.intrinsics);
  yaml << YAML::Key << "distortion_model" << YAML::Value << lens.distortion_model;
  write_list(yaml, "distortion_coeffs", lens.coefficients);
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

constexpr std::array kOrbSlamDepthScales = {"DepthMapFactor", "RGBD.DepthMapFactor"};
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

UnplacedCameras::UnplacedCameras(const InputError& fault, fs::path file, std::vector<std::string> names)
    : InputError(fault.place(), fault.reason(),
                 fmt::format("{}; one camera alone: {}#{}", fault.remedy(), file.string(), names.front())),
      file_(std::move(file)),
      names_(std::move(names)) {}

fs::path UnplacedCameras::camera(const std::string& name) const {
  return file_.string() + "#" + name;
}

fs::path UnplacedCameras::side(bool is_right) const {
  const std::string_view word = is_right ? "right" : "left";
  std::vector<std::string> found;
  for (const std::string& name : names_) {
    if (lower_case(name).find(word) != std::string::npos) found.push_back(name);
  }
  if (found.size() == 1) return camera(found.front());
  if (found.empty() && names_.size() == 2) return camera(names_[is_right ? 1 : 0]);
  throw InputError(file_.string(),
                   fmt::format("does not name one of its cameras {}: {}", word, fmt::join(names_, ", ")),
                   "give one by its name: " + camera(names_.front()).string());
}

CalibrationReading read_calibration_file(const fs::path& path, const std::optional<fs::path>& right,
                                         std::optional<std::pair<int, int>> size) {
  if (right) return read_pair(path, *right);
  if (!fs::is_directory(path)) return read_one(path, size);
  if (const auto pair = pair_in(path)) return read_pair(pair->first, pair->second);
  if (const auto file = find_calibration(path)) return read_one(*file);
  throw InputError(
      path.string(), "contains no camera calibration",
      "give the file, or add it as calibration.yaml, camera.yaml, sensor.yaml, or left.yaml and right.yaml");
}

Calibration read_calibration(const fs::path& path, const std::optional<fs::path>& right) {
  Calibration calibration = read_calibration_file(path, right).calibration;
  if (calibration.left.width > 0 && (!calibration.right || calibration.right->camera.width > 0)) return calibration;
  throw InputError(path.string(), "does not have the image size",
                   "convert it with \"byre calibration convert --size WIDTHxHEIGHT\"");
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
  DepthCamera depth;
  if (fs::is_directory(path)) return depth;
  const CalibrationFields fields = CalibrationFields::load(file_of_camera(path));
  for (const char* const field : kOrbSlamDepthScales) {
    if (fields.has(field)) depth.units_per_metre = fields.positive(field);
  }
  if (fields.has(kDepthScale)) depth.units_per_metre = fields.positive(kDepthScale);
  if (fields.has(kDepthSigma)) depth.sigma_at_one_metre = fields.positive(kDepthSigma);
  if (!fields.has(kDepthCamera)) return depth;
  const CalibrationFields own = fields.group(kDepthCamera);
  depth.camera = depth_lens(own);
  depth.left_from_depth = own.pose("colour_from_depth");
  return depth;
}

bool has_depth_camera_fields(const fs::path& path) {
  if (fs::is_directory(path)) return false;
  const CalibrationFields fields = CalibrationFields::load(file_of_camera(path));
  for (const char* const field : kOrbSlamDepthScales) {
    if (fields.has(field)) return true;
  }
  return fields.has(kDepthScale) || fields.has(kDepthSigma) || fields.has(kDepthCamera);
}

void require_baseline(const StereoPartner& partner, const std::string& place) {
  constexpr double kLeast = 1e-3;  // metres
  if (partner.right_from_left.translation.norm() >= kLeast) return;
  throw InputError(place, "places both cameras at the same position",
                   "calibrate the stereo pair, or use one camera alone");
}

std::optional<fs::path> find_calibration(const fs::path& folder) {
  for (const char* const name : {"calibration.yaml", "camera.yaml", "sensor.yaml"}) {
    if (fs::is_regular_file(folder / name)) return folder / name;
  }
  if (pair_in(folder)) return folder;
  return std::nullopt;
}

}  // namespace byre
