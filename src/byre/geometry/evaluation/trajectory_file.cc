#include "byre/trajectory_file.h"

#include "byre/base/output_file.h"
#include "byre/base/text_file.h"
#include "byre/geometry/evaluation/trajectory_lines.h"
#include "byre/input_error.h"

#include <array>
#include <cstdlib>
#include <span>

#include <fmt/format.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPoseFields = 8;    // time, position, quaternion
constexpr std::size_t kKittiFields = 12;  // a 3x4 matrix
constexpr double kUnitTolerance = 0.01;

using Fields = std::span<const std::string_view>;

std::vector<double> parse_numbers(Fields fields, const std::string& place) {
  std::vector<double> numbers;
  for (const std::string_view field : fields) {
    const std::optional<double> number = parse_number(field);
    if (!number) throw InputError(place, "\"" + std::string(field) + "\" is not a number");
    numbers.push_back(*number);
  }
  return numbers;
}

Eigen::Quaterniond unit_quaternion(double w, double x, double y, double z, const std::string& place) {
  const Eigen::Quaterniond rotation(w, x, y, z);
  if (std::abs(rotation.norm() - 1.0) > kUnitTolerance) {
    throw InputError(place, "the quaternion has length " + std::to_string(rotation.norm()) + ", not 1",
                     "check the order of the columns");
  }
  return rotation.normalized();
}

Timestamp time_of(const std::optional<Timestamp>& parsed, std::string_view field, std::string_view unit,
                  const std::string& place) {
  if (parsed) return *parsed;
  throw InputError(place, "\"" + std::string(field) + "\" is not a time in " + std::string(unit));
}

StampedPose parse_stamped_pose(const TextLine& line, TrajectoryFormat format, const std::string& place) {
  const std::vector<std::string_view> fields = split_fields(line.text);
  const bool enough = format == TrajectoryFormat::euroc ? fields.size() >= kPoseFields : fields.size() == kPoseFields;
  if (!enough) {
    throw InputError(place, "has " + std::to_string(fields.size()) + " columns instead of 8",
                     "expected: time, position and quaternion");
  }
  const std::vector<double> n = parse_numbers(Fields(fields).subspan(1, kPoseFields - 1), place);
  const Eigen::Quaterniond rotation = format == TrajectoryFormat::euroc
                                          ? unit_quaternion(n[3], n[4], n[5], n[6], place)
                                          : unit_quaternion(n[6], n[3], n[4], n[5], place);
  return {parse_time(line, place), {rotation, {n[0], n[1], n[2]}}};
}

Pose parse_kitti_pose(const TextLine& line, const std::string& place) {
  const std::vector<std::string_view> fields = split_fields(line.text);
  if (fields.size() != kKittiFields) {
    throw InputError(place, "has " + std::to_string(fields.size()) + " columns instead of 12",
                     "expected: the rows of a 3x4 matrix");
  }
  const std::vector<double> numbers = parse_numbers(fields, place);
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> world_from_camera(numbers.data());
  const std::optional<Eigen::Quaterniond> rotation = rotation_from_matrix(world_from_camera.leftCols<3>());
  if (!rotation) throw InputError(place, "the left 3x3 part is not a rotation");
  return {*rotation, world_from_camera.col(3)};
}

void require_later(Timestamp time, std::optional<Timestamp> previous, const std::string& place) {
  if (!previous || time > *previous) return;
  throw InputError(place, time == *previous ? "repeats the previous time stamp" : "is earlier than the line before it",
                   "sort the lines by time and remove duplicates");
}

std::string tum_line(const StampedPose& sample) {
  const std::int64_t count = sample.time.count();
  const auto [seconds, nanoseconds] = std::lldiv(std::llabs(count), 1'000'000'000);
  const Eigen::Vector3d& t = sample.world_from_body.translation;
  const Eigen::Quaterniond& q = sample.world_from_body.rotation;
  return fmt::format("{}{}.{:09} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", count < 0 ? "-" : "", seconds,
                     nanoseconds, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

std::string euroc_line(const StampedPose& sample) {
  const Eigen::Vector3d& t = sample.world_from_body.translation;
  const Eigen::Quaterniond& q = sample.world_from_body.rotation;
  return fmt::format("{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f}\n", sample.time.count(), t.x(), t.y(), t.z(),
                     q.w(), q.x(), q.y(), q.z());
}

std::string kitti_line(const StampedPose& sample) {
  Eigen::Matrix<double, 3, 4, Eigen::RowMajor> world_from_body;
  world_from_body << sample.world_from_body.rotation.toRotationMatrix(), sample.world_from_body.translation;
  return fmt::format("{:.9f}\n", fmt::join(world_from_body.reshaped<Eigen::RowMajor>(), " "));
}

struct WrittenFormat {
  const char* head;
  std::string (*line)(const StampedPose& sample);
};

// By TrajectoryFormat.
constexpr std::array kWrittenFormats = {
    WrittenFormat{"# timestamp tx ty tz qx qy qz qw\n", tum_line},
    WrittenFormat{"#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n",
                  euroc_line},
    WrittenFormat{"", kitti_line}};

// Calls use(pose, place) for each pose; place: file and line.
template <typename Use>
void for_each_pose(const fs::path& path, const Use& use) {
  const TrajectoryFormat format = guess_trajectory_format(path);
  if (format == TrajectoryFormat::kitti) {
    throw InputError(path.string(), "is in KITTI format, which has no time stamps", "also give a file of times");
  }
  for (const TextLine& line : read_lines(path)) {
    const std::string place = place_of(path, line);
    use(parse_stamped_pose(line, format, place), place);
  }
}

}  // namespace

Timestamp parse_time(const TextLine& line, const std::string& place) {
  const std::string_view first = split_fields(line.text).front();
  if (line.text.find(',') != std::string::npos) return time_of(parse_nanoseconds(first), first, "nanoseconds", place);
  // Integers too large for seconds are nanoseconds, as ORB-SLAM3 writes them, with zeros after the point.
  std::optional<Timestamp> time = parse_seconds(first);
  const std::string_view whole = first.substr(0, first.find('.'));
  const bool is_whole = first.find_first_not_of(".0", whole.size()) == std::string_view::npos;
  if (!time && is_whole) time = parse_nanoseconds(whole);
  return time_of(time, first, "seconds", place);
}

TrajectoryFormat guess_trajectory_format(const fs::path& path) {
  const std::vector<TextLine> lines = read_lines(path);
  if (lines.empty()) throw InputError(path.string(), "contains no poses");
  const std::string& first = lines.front().text;
  if (first.find(',') != std::string::npos) return TrajectoryFormat::euroc;
  const std::size_t columns = split_fields(first).size();
  if (columns == kKittiFields) return TrajectoryFormat::kitti;
  if (columns == kPoseFields) return TrajectoryFormat::tum;
  throw InputError(place_of(path, lines.front()),
                   "has " + std::to_string(columns) + " columns, which matches no supported trajectory format",
                   "TUM has 8 columns, KITTI 12, EuRoC at least 8 separated by commas");
}

Trajectory read_trajectory(const fs::path& path) {
  if (fs::is_directory(path)) {
    const std::optional<fs::path> truth = find_euroc_ground_truth(path);
    if (!truth)
      throw InputError(path.string(), "contains no ground truth in mav0/state_groundtruth_estimate0/data.csv");
    return read_trajectory(*truth);
  }
  Trajectory trajectory;
  for_each_pose(path, [&](const StampedPose& sample, const std::string& place) {
    require_later(sample.time, trajectory.empty() ? std::nullopt : std::optional(trajectory.back().time), place);
    trajectory.push_back(sample);
  });
  return trajectory;
}

Trajectory parse_pose_lines(const fs::path& path) {
  Trajectory trajectory;
  for_each_pose(path, [&](const StampedPose& sample, const std::string&) { trajectory.push_back(sample); });
  return trajectory;
}

Trajectory read_kitti_poses(const fs::path& poses, const fs::path& times) {
  const std::vector<TextLine> lines = read_lines(poses);
  const std::vector<Timestamp> stamps = read_times(times);
  if (lines.size() != stamps.size()) {
    throw InputError(poses.string(),
                     "contains " + std::to_string(lines.size()) + " poses, but " + times.string() + " contains " +
                         std::to_string(stamps.size()) + " times",
                     "give the times file of the same sequence");
  }
  Trajectory trajectory;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    trajectory.push_back({stamps[i], parse_kitti_pose(lines[i], place_of(poses, lines[i]))});
  }
  return trajectory;
}

std::vector<Timestamp> read_times(const fs::path& path) {
  std::vector<Timestamp> times;
  for (const TextLine& line : read_lines(path)) {
    const std::string place = place_of(path, line);
    const Timestamp time = parse_time(line, place);
    require_later(time, times.empty() ? std::nullopt : std::optional(times.back()), place);
    times.push_back(time);
  }
  if (times.empty()) throw InputError(path.string(), "contains no times");
  return times;
}

void write_trajectory(const Trajectory& trajectory, const fs::path& path, TrajectoryFormat format) {
  OutputFile file(path, FileContent::trajectory);
  const auto [head, line] = kWrittenFormats.at(static_cast<std::size_t>(format));
  std::string text(head);
  for (const StampedPose& sample : trajectory) text += line(sample);
  file.append(text);
  file.publish();
}

std::optional<fs::path> find_euroc_ground_truth(const fs::path& folder) {
  for (const char* const mav : {"mav0", "."}) {
    for (const char* const source : {"state_groundtruth_estimate0", "mocap0"}) {
      const fs::path file = (folder / mav / source / "data.csv").lexically_normal();
      if (fs::exists(file)) return file;
    }
  }
  return std::nullopt;
}

}  // namespace byre
