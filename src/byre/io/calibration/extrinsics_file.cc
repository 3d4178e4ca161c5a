#include "byre/extrinsics_file.h"

#include "byre/base/output_file.h"
#include "byre/base/regular_file.h"
#include "byre/calibration_file.h"
#include "byre/geometry/degrees.h"
#include "byre/input_error.h"
#include "byre/io/calibration/calibration_fields.h"
#include "byre/io/calibration/frame_tree.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <vector>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBaseFromCamera = "base_from_camera";
constexpr const char* kBaseFromImu = "base_from_imu";
constexpr const char* kCameraAxes = "camera_axes";
constexpr const char* kWheels = "wheels";
constexpr const char* kTranslation = "translation_m";
constexpr const char* kQuaternion = "rotation_xyzw";
constexpr const char* kRollPitchYaw = "rpy_deg";
constexpr const char* kMatrix = "matrix";
constexpr const char* kSigmaMetres = "sigma_m";
constexpr const char* kSigmaDegrees = "sigma_deg";
constexpr const char* kScale = "scale";
constexpr const char* kScaleSigma = "scale_sigma";
constexpr const char* kDelay = "delay_s";

using Names = std::initializer_list<const char*>;
constexpr Names kFields = {kBaseFromCamera, kBaseFromImu, kCameraAxes, kWheels};
constexpr Names kFieldsOfMounting = {kTranslation, kQuaternion, kRollPitchYaw, kMatrix, kSigmaMetres, kSigmaDegrees};
constexpr Names kRotations = {kQuaternion, kRollPitchYaw, kMatrix};
constexpr Names kFieldsOfWheels = {kScale, kScaleSigma, kDelay};

bool is_in(const std::string& name, Names names) {
  return std::ranges::find(names, name) != names.end();
}

// Throws InputError for an unknown field, and for one that is empty or given twice. has_others: fields of other names
// are allowed, unless they begin as those of extrinsics, which suggests a spelling error.
void require_known(const CalibrationFields& fields, Names known, bool has_others = false) {
  std::vector<std::string> names = fields.names();
  if (has_others) {
    std::erase_if(names,
                  [&](const std::string& name) { return !is_in(name, known) && !name.starts_with("base_from"); });
  }
  for (const std::string& name : names) {
    if (!is_in(name, known)) {
      throw InputError(fields.place(name), "is not a field of extrinsics",
                       fmt::format("fields: {}", fmt::join(known, ", ")));
    }
    if (!fields.has(name)) throw InputError(fields.place(name), "is empty");
    if (std::ranges::count(names, name) > 1) throw InputError(fields.place(name), "is given twice");
  }
}

// Whether the file also calibrates cameras, so that it has fields of other names.
bool is_calibration(const fs::path& path) {
  try {
    return has_depth_camera_fields(path) || read_calibration_file(path).calibration.left.fx > 0.0;
  } catch (const UnplacedCameras&) {
    return true;
  } catch (const InputError&) {
    return false;
  }
}

double small_positive(const CalibrationFields& fields, const char* field, double largest, const char* remedy) {
  const double number = fields.positive(field);
  if (number <= largest) return number;
  throw InputError(fields.place(field), fmt::format("is above {:g}", largest), remedy);
}

Eigen::Quaterniond rotation_of(const CalibrationFields& fields) {
  constexpr double kRounding = 1e-3;
  if (fields.has(kQuaternion)) {
    const std::vector<double> xyzw = fields.numbers(kQuaternion, 4);
    const Eigen::Quaterniond rotation(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
    if (std::abs(rotation.norm() - 1.0) < kRounding) return rotation.normalized();
    throw InputError(fields.place(kQuaternion), fmt::format("has the length {:.4g} instead of 1", rotation.norm()),
                     "give a unit quaternion as x, y, z, w");
  }
  if (fields.has(kRollPitchYaw)) {
    const std::vector<double> degrees = fields.numbers(kRollPitchYaw, 3);
    return rotation_from_rpy(kDegree * Eigen::Map<const Eigen::Vector3d>(degrees.data()));
  }
  const auto rotation = rotation_from_matrix(fields.matrix(kMatrix));
  if (rotation) return *rotation;
  throw InputError(fields.place(kMatrix), "is not a rotation", "give the matrix row by row");
}

// Pose of a group: translation and one rotation, or a matrix of both.
Pose pose_of_group(const CalibrationFields& fields, const std::string& place) {
  const auto rotations = std::ranges::count_if(kRotations, [&](const char* name) { return fields.has(name); });
  if (rotations != 1) {
    throw InputError(place, fmt::format("has {} rotations instead of one", rotations),
                     fmt::format("give one of {}", fmt::join(kRotations, ", ")));
  }
  if (!fields.has(kMatrix) || fields.numbers(kMatrix).size() == 9) {
    const std::vector<double> metres = fields.numbers(kTranslation, 3);
    return {rotation_of(fields), Eigen::Map<const Eigen::Vector3d>(metres.data())};
  }
  if (!fields.has(kTranslation)) return fields.pose(kMatrix);
  throw InputError(fields.place(kMatrix), fmt::format("has a translation, as {} has", kTranslation),
                   fmt::format("give 9 numbers, or omit {}", kTranslation));
}

std::optional<SensorMounting> mounting_of(const CalibrationFields& fields, const char* name) {
  if (!fields.has(name)) return std::nullopt;
  SensorMounting mounting;
  const std::string place = fields.place(name);
  const bool is_matrix = !fields.is_group(name) || fields.group(name).has("data");
  if (!is_matrix) {
    const CalibrationFields group = fields.group(name);
    require_known(group, kFieldsOfMounting);
    mounting.base_from_sensor = pose_of_group(group, place);
    if (group.has(kSigmaMetres)) mounting.sigma_m = small_positive(group, kSigmaMetres, 20.0, "give metres");
    if (group.has(kSigmaDegrees)) {
      mounting.sigma_rad = kDegree * small_positive(group, kSigmaDegrees, 180.0, "give degrees");
    }
  } else {
    mounting.base_from_sensor = fields.pose(name);
  }
  require_metres(mounting.base_from_sensor, place);
  return mounting;
}

// x ahead, y left, z up, from x right, y down, z ahead.
Pose body_from_optical() {
  Eigen::Matrix3d axes;
  axes << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return {Eigen::Quaterniond(axes), Eigen::Vector3d::Zero()};
}

std::optional<SensorMounting> camera_of(const CalibrationFields& fields) {
  std::optional<SensorMounting> camera = mounting_of(fields, kBaseFromCamera);
  const std::string axes = fields.has(kCameraAxes) ? fields.text(kCameraAxes) : "";
  if (!axes.empty() && axes != "optical" && axes != "body") {
    throw InputError(fields.place(kCameraAxes), fmt::format("\"{}\" is unknown", axes), "give optical or body");
  }
  if (!camera) return camera;
  if (axes == "body") camera->base_from_sensor = camera->base_from_sensor * body_from_optical();
  if (axes.empty() && is_z_vertical(camera->base_from_sensor)) {
    throw InputError(fields.place(kBaseFromCamera), "has a vertical z axis in the base, but that of a camera is ahead",
                     fmt::format("add \"{}: body\" if x is ahead and z up, or \"{}: optical\" if the camera looks up "
                                 "or down",
                                 kCameraAxes, kCameraAxes));
  }
  return camera;
}

void require_wheel_scale(double scale, const std::string& place) {
  constexpr double kMost = 2.0;
  if (scale <= kMost && scale >= 1.0 / kMost) return;
  throw InputError(place, fmt::format("is {:.4g}, outside {:g} to {:g}", scale, 1.0 / kMost, kMost),
                   "give true metres per metre of the wheel odometry, about 1");
}

void read_wheels(const CalibrationFields& fields, Extrinsics& extrinsics) {
  constexpr double kMostDelay = 1.0;  // seconds
  require_known(fields, kFieldsOfWheels);
  if (fields.has(kScale)) extrinsics.wheel_scale = fields.positive(kScale);
  require_wheel_scale(extrinsics.wheel_scale, fields.place(kScale));
  if (fields.has(kScaleSigma)) {
    extrinsics.wheel_scale_sigma = small_positive(fields, kScaleSigma, 1.0, "give a share of the scale, as 0.03");
  }
  if (!fields.has(kDelay)) return;
  extrinsics.wheel_delay = fields.number(kDelay);
  if (std::abs(*extrinsics.wheel_delay) > kMostDelay) {
    throw InputError(fields.place(kDelay), fmt::format("is above {:g} s", kMostDelay), "give seconds");
  }
}

Extrinsics read_fields(const fs::path& path) {
  const CalibrationFields fields = CalibrationFields::load(path);
  require_known(fields, kFields, is_calibration(path));
  if (!fields.has(kBaseFromCamera) && !fields.has(kBaseFromImu) && !fields.has(kWheels)) {
    throw InputError(path.string(), "has no extrinsics of a robot",
                     fmt::format("fields: {}", fmt::join(kFields, ", ")));
  }
  Extrinsics extrinsics;
  extrinsics.camera = camera_of(fields);
  extrinsics.imu = mounting_of(fields, kBaseFromImu);
  if (fields.has(kWheels)) read_wheels(fields.group(kWheels), extrinsics);
  return extrinsics;
}

// Text of the file if it is XML but not of OpenCV, else empty.
std::string other_xml(const fs::path& path) {
  constexpr std::streamsize kLargest = 8 << 20;  // bytes
  constexpr std::size_t kProbe = 4096;           // bytes
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path.string(), "cannot be opened", "check that it exists and is readable");
  std::string text(kProbe, '\0');
  file.read(text.data(), kProbe);
  text.resize(static_cast<std::size_t>(file.gcount()));
  std::size_t begin = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  begin = text.find_first_not_of(" \t\r\n", begin);
  const bool is_xml = begin != std::string::npos && text[begin] == '<';
  if (!is_xml || text.find("<opencv_storage") != std::string::npos) return "";
  std::string rest(kLargest, '\0');
  file.read(rest.data(), kLargest);
  rest.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  if (rest.size() == kLargest) throw InputError(path.string(), "is XML larger than 8 MB, so it is no URDF");
  return text + rest;
}

std::vector<std::string> texts_of(const Eigen::Ref<const Eigen::VectorXd>& numbers) {
  std::vector<std::string> texts;
  for (const double number : numbers) texts.push_back(fmt::format("{}", number));
  return texts;
}

void write_number(YAML::Emitter& yaml, const char* name, double number) {
  yaml << YAML::Key << name << YAML::Value << fmt::format("{}", number);
}

void write_mounting(YAML::Emitter& yaml, const char* name, const SensorMounting& mounting) {
  const Eigen::Vector3d& translation = mounting.base_from_sensor.translation;
  const Eigen::Vector4d xyzw = mounting.base_from_sensor.rotation.coeffs();
  assert(translation.allFinite() && xyzw.allFinite() && mounting.sigma_m > 0.0 && mounting.sigma_rad > 0.0);
  yaml << YAML::Key << name << YAML::Value << YAML::BeginMap;
  yaml << YAML::Key << kTranslation << YAML::Value << YAML::Flow << texts_of(translation);
  yaml << YAML::Key << kQuaternion << YAML::Value << YAML::Flow << texts_of(xyzw);
  write_number(yaml, kSigmaMetres, mounting.sigma_m);
  write_number(yaml, kSigmaDegrees, mounting.sigma_rad / kDegree);
  yaml << YAML::EndMap;
}

}  // namespace

Extrinsics read_extrinsics(const fs::path& path, const ExtrinsicsFrames& frames) {
  refuse_pipe(path);
  if (const auto tree = read_bag_frames(path)) return extrinsics_of(*tree, frames);
  if (fs::is_directory(path)) {
    throw InputError(path.string(), "is a folder, but no bag", "give a YAML file, a URDF or a bag");
  }
  const std::string xml = other_xml(path);
  return xml.empty() ? read_fields(path) : extrinsics_of(parse_urdf(xml, path.string()), frames);
}

void write_extrinsics(const fs::path& path, const Extrinsics& extrinsics) {
  const std::string place = path.string() + ": ";
  if (extrinsics.camera) require_metres(extrinsics.camera->base_from_sensor, place + kBaseFromCamera);
  if (extrinsics.imu) require_metres(extrinsics.imu->base_from_sensor, place + kBaseFromImu);
  require_wheel_scale(extrinsics.wheel_scale, place + kWheels + "." + kScale);
  YAML::Emitter yaml;
  yaml << YAML::Comment("Extrinsics of a robot. Base: x ahead, y left, z up; metres") << YAML::BeginMap;
  if (extrinsics.camera) {
    write_mounting(yaml, kBaseFromCamera, *extrinsics.camera);
    yaml << YAML::Key << kCameraAxes << YAML::Value << "optical";
  }
  if (extrinsics.imu) write_mounting(yaml, kBaseFromImu, *extrinsics.imu);
  yaml << YAML::Key << kWheels << YAML::Value << YAML::BeginMap;
  write_number(yaml, kScale, extrinsics.wheel_scale);
  write_number(yaml, kScaleSigma, extrinsics.wheel_scale_sigma);
  if (extrinsics.wheel_delay) write_number(yaml, kDelay, *extrinsics.wheel_delay);
  yaml << YAML::EndMap << YAML::EndMap;
  write_atomically(path, std::string(yaml.c_str()) + "\n");
}

}  // namespace byre
