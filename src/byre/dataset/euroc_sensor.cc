#include "byre/dataset/euroc_sensor.h"

#include "byre/input/input_error.h"
#include "byre/input/text_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include <yaml-cpp/yaml.h>

namespace byre {
namespace {

constexpr int kMaxSide = 20000;  // pixels

// A sensor.yaml, and the name to blame for what is wrong in it.
struct SensorFile {
  std::filesystem::path path;
  YAML::Node root;

  std::string place(const std::string& field) const { return path.string() + ": " + field; }
};

// OpenCV writes "%YAML:1.0" in the first line, which is no directive of YAML's; a comment keeps the line numbers.
std::string readable_yaml(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path.string(), "cannot be opened", "check that it exists and may be read");
  std::ostringstream text;
  text << file.rdbuf();
  std::string yaml = text.str();
  if (yaml.starts_with("%YAML:")) yaml.front() = '#';
  return yaml;
}

SensorFile load_sensor_file(const std::filesystem::path& path) {
  try {
    SensorFile file{path, YAML::Load(readable_yaml(path))};
    if (!file.root.IsMap()) throw InputError(path.string(), "is not a YAML file of named fields");
    return file;
  } catch (const YAML::Exception& error) {
    throw InputError(path.string() + ":" + std::to_string(error.mark.line + 1), error.msg, "correct the YAML");
  }
}

std::vector<double> to_numbers(const YAML::Node& list, const std::string& place) {
  if (!list) throw InputError(place, "is missing");
  if (!list.IsSequence()) throw InputError(place, "is not a list of numbers");
  std::vector<double> numbers;
  for (const YAML::Node& entry : list) {
    const std::optional<double> number = entry.IsScalar() ? parse_number(entry.Scalar()) : std::nullopt;
    if (!number) throw InputError(place, "holds something that is not a number");
    numbers.push_back(*number);
  }
  return numbers;
}

void require_count(const std::vector<double>& numbers, std::size_t count, const std::string& place) {
  if (numbers.size() == count) return;
  throw InputError(place, "has " + std::to_string(numbers.size()) + " numbers instead of " + std::to_string(count));
}

std::vector<double> read_numbers(const SensorFile& file, const std::string& field, std::size_t count) {
  std::vector<double> numbers = to_numbers(file.root[field], file.place(field));
  require_count(numbers, count, file.place(field));
  return numbers;
}

std::string read_word(const SensorFile& file, const std::string& field) {
  const YAML::Node node = file.root[field];
  if (!node) throw InputError(file.place(field), "is missing");
  if (!node.IsScalar()) throw InputError(file.place(field), "is not a word");
  return node.Scalar();
}

Pose read_body_from_camera(const SensorFile& file) {
  const std::string place = file.place("T_BS");
  const YAML::Node node = file.root["T_BS"];
  const std::vector<double> numbers = to_numbers(node && node.IsMap() ? node["data"] : node, place);
  require_count(numbers, 16, place);
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> body_from_camera(numbers.data());
  const std::optional<Eigen::Quaterniond> rotation = rotation_from_matrix(body_from_camera.topLeftCorner<3, 3>());
  if (!rotation) throw InputError(place, "its 3x3 part is not a rotation", "give the rows of body from camera");
  if (body_from_camera.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)) {
    throw InputError(place, "its last row is not 0 0 0 1", "give the matrix row by row");
  }
  return {*rotation, body_from_camera.topRightCorner<3, 1>()};
}

int read_side(double pixels, const std::string& place) {
  if (pixels >= 1.0 && pixels <= kMaxSide && pixels == std::floor(pixels)) return static_cast<int>(pixels);
  throw InputError(place, "is not a width and a height in pixels");
}

void read_resolution(const SensorFile& file, Camera& camera) {
  const std::vector<double> resolution = read_numbers(file, "resolution", 2);
  camera.width = read_side(resolution[0], file.place("resolution"));
  camera.height = read_side(resolution[1], file.place("resolution"));
}

void read_intrinsics(const SensorFile& file, Camera& camera) {
  const std::string place = file.place("intrinsics");
  const std::vector<double> intrinsics = read_numbers(file, "intrinsics", 4);
  camera.fx = intrinsics[0];
  camera.fy = intrinsics[1];
  camera.cx = intrinsics[2];
  camera.cy = intrinsics[3];
  if (camera.fx <= 0.0 || camera.fy <= 0.0) throw InputError(place, "the focal lengths must be positive");
  if (!camera.contains({camera.cx, camera.cy})) {
    throw InputError(place, "the principal point lies outside the image", "check that they belong to this resolution");
  }
}

CameraModel read_model(const SensorFile& file) {
  if (const std::string model = read_word(file, "camera_model"); model != "pinhole") {
    throw InputError(file.place("camera_model"), "\"" + model + "\" is not supported", "use pinhole");
  }
  const std::string distortion = read_word(file, "distortion_model");
  if (distortion == "radial-tangential" || distortion == "radtan") return CameraModel::radial_tangential;
  if (distortion == "equidistant") return CameraModel::equidistant;
  if (distortion == "none") return CameraModel::pinhole;
  throw InputError(file.place("distortion_model"), "\"" + distortion + "\" is not supported",
                   "use radial-tangential, equidistant or none");
}

void read_distortion(const SensorFile& file, Camera& camera) {
  camera.model = read_model(file);
  if (camera.model == CameraModel::pinhole) return;
  const std::string place = file.place("distortion_coefficients");
  const std::vector<double> coefficients = to_numbers(file.root["distortion_coefficients"], place);
  const bool has_k3 = camera.model == CameraModel::radial_tangential && coefficients.size() == 5;
  if (!has_k3) require_count(coefficients, 4, place);
  std::copy(coefficients.begin(), coefficients.end(), camera.distortion.begin());
}

}  // namespace

EurocSensor read_euroc_sensor(const std::filesystem::path& path) {
  const SensorFile file = load_sensor_file(path);
  EurocSensor sensor;
  read_resolution(file, sensor.camera);
  read_intrinsics(file, sensor.camera);
  read_distortion(file, sensor.camera);
  sensor.body_from_camera = read_body_from_camera(file);
  return sensor;
}

}  // namespace byre
