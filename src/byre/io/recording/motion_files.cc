#include "byre/io/recording/motion_files.h"

#include "byre/base/text_file.h"
#include "byre/geometry/evaluation/trajectory_lines.h"
#include "byre/input_error.h"
#include "byre/io/calibration/calibration_fields.h"
#include "byre/io/recording/recording_index.h"

#include <chrono>
#include <cmath>
#include <utility>

namespace byre {
namespace {

constexpr double kRestSpeed = 1e-3;                            // metres, or radians, per second
constexpr double kMinMotion = 0.05;                            // metres, or radians
constexpr Timestamp kMaxGap = std::chrono::milliseconds(300);  // largest gap between integrated velocities

bool is_at_rest(const std::optional<BaseTwist>& velocity) {
  return !velocity || (std::hypot(velocity->vx, velocity->vy) < kRestSpeed && std::abs(velocity->wz) < kRestSpeed);
}

bool is_same(const Pose& one, const Pose& other) {
  return one.translation == other.translation && one.rotation.coeffs() == other.rotation.coeffs();
}

namespace fs = std::filesystem;

// Three numbers, beginning at a field.
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

// Format: "time_ns, w_x, w_y, w_z, a_x, a_y, a_z"; the last three may be missing.
ImuSample parse_imu_line(const TextLine& line, const std::string& place) {
  constexpr std::size_t kMinFields = 4, kAllFields = 7;
  const std::vector<std::string_view> fields = split_fields(line.text);
  if (fields.size() < kMinFields) {
    throw InputError(place, "has fewer than four fields", "expected: a time in nanoseconds and three rates in rad/s");
  }
  const std::optional<Timestamp> time = parse_nanoseconds(fields[0]);
  if (!time) throw InputError(place, "\"" + std::string(fields[0]) + "\" is not a time in nanoseconds");
  ImuSample sample{*time, AngularRate{*time, parse_vector(fields, 1, place)}};
  if (fields.size() < kAllFields) return sample;
  const Eigen::Vector3d acceleration = parse_vector(fields, kMinFields, place);
  if (!acceleration.isZero(0.0)) sample.acceleration = {*time, acceleration};
  return sample;
}

// Continuous times of the lines of a file.
RestoredTimes restore_lines(std::vector<Timestamp> stamps, const fs::path& path, const SensorClock& images,
                            std::vector<std::string>& warnings) {
  RestoredTimes restored = restore_times({std::move(stamps)}, images);
  const std::vector<std::string> lines = describe(restored.corrections, {path.string(), "line", "line"});
  warnings.insert(warnings.end(), lines.begin(), lines.end());
  return restored;
}

void read_imu(const fs::path& path, const SensorClock& images, SensorMotion& motion) {
  std::vector<ImuSample> listed;
  std::vector<Timestamp> stamps;
  for (const TextLine& line : read_lines(path)) {
    listed.push_back(parse_imu_line(line, place_of(path, line)));
    stamps.push_back(listed.back().time);
  }
  const RestoredTimes restored = restore_lines(std::move(stamps), path, images, motion.warnings);
  for (std::size_t i = 0; i < restored.items.size(); ++i) {
    const Timestamp time = restored.times[i];
    const ImuSample& sample = listed[restored.items[i]];
    motion.samples.rates.push_back({time, sample.rate->rate});
    if (sample.acceleration) motion.samples.accelerations.push_back({time, sample.acceleration->acceleration});
  }
}

Eigen::Quaterniond read_body_from_imu(const fs::path& path) {
  return CalibrationFields::load(path).pose("T_BS").rotation;
}

fs::path rates_of(const fs::path& recording) {
  const auto folder = find_mav_folder(recording);
  const fs::path path = folder.value_or(recording) / "imu0" / "data.csv";
  if (fs::is_regular_file(path)) return path;
  throw InputError(path.string(), "does not exist", "omit the gyroscope, or add its samples as this file");
}

}  // namespace

// Integrates velocities with their sign, so that noise at rest does not add up to motion.
bool WheelStream::accumulate_motion(const WheelSample& sample) {
  if (!sample.velocity) return false;
  const BaseTwist& now = *sample.velocity;
  if (last_ && now.time > last_->time && now.time - last_->time <= kMaxGap) {
    const Eigen::Vector3d sum(last_->vx + now.vx, last_->vy + now.vy, last_->wz + now.wz);
    moved_ += 0.5 * to_seconds(now.time - last_->time) * sum;
  }
  last_ = now;
  return moved_.head<2>().norm() > kMinMotion || std::abs(moved_.z()) > kMinMotion;
}

void WheelStream::emit(const WheelSample& sample) {
  if (kind_ == Kind::velocities) {
    if (sample.velocity) output_.push_back({sample.time, {}, sample.velocity});
  } else if (sample.pose) {
    output_.push_back({sample.time, sample.pose, {}});
  }
}

void WheelStream::decide(Kind kind) {
  kind_ = kind;
  for (const WheelSample& sample : std::exchange(pending_, {})) emit(sample);
}

void WheelStream::add(const WheelSample& sample) {
  if (sample.pose && !first_) first_ = sample.pose;
  const bool has_pose_changed = sample.pose && !is_same(*sample.pose, *first_);
  if (has_pose_changed && kind_ != Kind::poses) decide(Kind::poses);
  if (kind_ != Kind::open) return emit(sample);
  const bool has_moved = accumulate_motion(sample);
  if (pending_.empty() && sample.pose && is_at_rest(sample.velocity)) return emit(sample);
  pending_.push_back(sample);
  if (has_moved || !sample.pose) decide(Kind::velocities);
}

std::vector<WheelSample> WheelStream::take() {
  return std::exchange(output_, {});
}

Trajectory read_wheel_file(const fs::path& path, const SensorClock& images, std::vector<std::string>& warnings) {
  Trajectory wheels = parse_pose_lines(path);
  std::vector<Timestamp> stamps;
  for (const StampedPose& sample : wheels) stamps.push_back(sample.time);
  const RestoredTimes restored = restore_lines(std::move(stamps), path, images, warnings);
  Trajectory in_order;
  for (std::size_t i = 0; i < restored.items.size(); ++i) {
    in_order.push_back({restored.times[i], wheels[restored.items[i]].world_from_body});
  }
  return in_order;
}

SensorMotion read_motion(const fs::path& recording, const OpenOptions& options, const Pose& body_from_left,
                         const SensorClock& images) {
  SensorMotion motion;
  const fs::path beside = recording / "wheel.txt";
  if (options.wheels) {
    motion.samples.wheels = read_wheel_file(*options.wheels, images, motion.warnings);
  } else if (options.use_wheels && fs::is_regular_file(beside)) {
    motion.samples.wheels = read_wheel_file(beside, images, motion.warnings);
  }
  if (options.use_gyroscope) {
    const fs::path imu = rates_of(recording);
    read_imu(imu, images, motion);
    const fs::path sensor = imu.parent_path() / "sensor.yaml";
    const bool is_of_same_body = !options.calibration;  // another calibration may define another body frame
    if (is_of_same_body && fs::is_regular_file(sensor)) {
      motion.samples.left_from_gyroscope = body_from_left.rotation.conjugate() * read_body_from_imu(sensor);
    }
  }
  return motion;
}

std::string motion_source(const fs::path& recording, const OpenOptions& options, MotionSensor sensor) {
  if (sensor == MotionSensor::tags) return "";
  const bool is_wheels = sensor == MotionSensor::wheels;
  if (is_wheels && options.wheels) return options.wheels->string();
  const auto& topic = is_wheels ? options.wheels_topic : options.imu_topic;
  if (topic) return recording.string() + ": " + *topic;
  if (is_wheels) return (recording / "wheel.txt").string();
  const auto folder = find_mav_folder(recording);
  return folder ? (*folder / "imu0" / "data.csv").string() : recording.string();
}

}  // namespace byre
