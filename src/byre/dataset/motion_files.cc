#include "byre/dataset/motion_files.h"

#include "byre/dataset/calibration_fields.h"
#include "byre/dataset/recording_index.h"
#include "byre/input/text_file.h"
#include "byre/input_error.h"
#include "byre/trajectory_file.h"

#include <array>

namespace byre {
namespace {

namespace fs = std::filesystem;

// Three numbers from a field on.
Eigen::Vector3d parse_vector(const std::vector<std::string_view>& fields, std::size_t first, const std::string& place) {
  Eigen::Vector3d vector;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view field = fields[first + static_cast<std::size_t>(axis)];
    const std::optional<double> number = parse_number(field);
    if (!number) throw InputError(place, "\"" + std::string(field) + "\" is not a number");
    vector[axis] = *number;
  }
  return vector;
}

// "time_ns, w_x, w_y, w_z, a_x, a_y, a_z", the last three of which may be missing.
void parse_line(const TextLine& line, const std::string& place, MotionSamples& samples) {
  constexpr std::size_t kLeastFields = 4, kAllFields = 7;
  const std::vector<std::string_view> fields = split_fields(line.text);
  if (fields.size() < kLeastFields) {
    throw InputError(place, "has fewer than four fields", "a time in nanoseconds and three rates in rad/s are needed");
  }
  const std::optional<Timestamp> time = parse_nanoseconds(fields[0]);
  if (!time) throw InputError(place, "\"" + std::string(fields[0]) + "\" is not a time in nanoseconds");
  if (!samples.rates.empty() && *time <= samples.rates.back().time) {
    throw InputError(place, "the time stamp is not later than the one before it", "sort the lines by time");
  }
  samples.rates.push_back({*time, parse_vector(fields, 1, place)});
  if (fields.size() < kAllFields) return;
  const Eigen::Vector3d acceleration = parse_vector(fields, kLeastFields, place);
  if (!acceleration.isZero(0.0)) samples.accelerations.push_back({*time, acceleration});
}

void read_imu(const fs::path& path, MotionSamples& samples) {
  for (const TextLine& line : read_lines(path)) parse_line(line, place_of(path, line), samples);
}

Eigen::Quaterniond read_body_from_imu(const fs::path& path) {
  return CalibrationFields::load(path).pose("T_BS").rotation;
}

fs::path rates_of(const fs::path& recording) {
  const auto folder = find_mav_folder(recording);
  const fs::path path = folder.value_or(recording) / "imu0" / "data.csv";
  if (fs::is_regular_file(path)) return path;
  throw InputError(path.string(), "is not there", "leave the gyroscope out, or put what it recorded there");
}

}  // namespace

MotionSamples read_motion(const fs::path& recording, const OpenOptions& options, const Pose& body_from_left) {
  MotionSamples samples;
  const fs::path beside = recording / "wheel.txt";
  if (options.wheels) {
    samples.wheels = read_trajectory(*options.wheels);
  } else if (options.use_wheels && fs::is_regular_file(beside)) {
    samples.wheels = read_trajectory(beside);
  }
  if (options.use_gyroscope) {
    const fs::path imu = rates_of(recording);
    read_imu(imu, samples);
    const fs::path sensor = imu.parent_path() / "sensor.yaml";
    const bool is_of_same_body = !options.calibration;  // a calibration of somebody else's may have another one
    if (is_of_same_body && fs::is_regular_file(sensor)) {
      samples.left_from_gyroscope = body_from_left.rotation.conjugate() * read_body_from_imu(sensor);
    }
  }
  return samples;
}

std::string motion_source(const fs::path& recording, const OpenOptions& options, MotionSensor sensor) {
  const bool is_wheels = sensor == MotionSensor::wheels;
  if (is_wheels && options.wheels) return options.wheels->string();
  const auto& topic = is_wheels ? options.wheels_topic : options.imu_topic;
  if (topic) return recording.string() + ": " + *topic;
  if (is_wheels) return (recording / "wheel.txt").string();
  const auto folder = find_mav_folder(recording);
  return folder ? (*folder / "imu0" / "data.csv").string() : recording.string();
}

}  // namespace byre
