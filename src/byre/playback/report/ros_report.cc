#include "byre/playback/report/ros_report.h"

#include "byre/map/point_grey.h"
#include "byre/playback/report/report.h"
#include "byre/slam/localisation/pose_filter.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace byre {
namespace {

using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

ros::Quaternion ros_rotation(const Eigen::Quaterniond& rotation) {
  return {rotation.x(), rotation.y(), rotation.z(), rotation.w()};
}

ros::Vector3 ros_vector(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

// Standard deviations of the acceleration of an indoor robot: m/s^2, rad/s^2. Nav2 limits them to 2.5 and 3.2.
constexpr double kAcceleration = 1.0;
constexpr double kTurnAcceleration = 2.0;

bool is_known(const Matrix6& covariance) {
  return covariance.allFinite() && position_variance(covariance) > 0.0 && rotation_variance(covariance) > 0.0;
}

Matrix6 twist_covariance(const OdometrySample& before, const OdometrySample& now) {
  const double seconds = to_seconds(now.time - before.time);
  const Pose now_from_before = inverse(now.odom_from_base) * before.odom_from_base;
  Matrix6 covariance = (now.covariance + move_covariance(before.covariance, now_from_before)) / (seconds * seconds);
  // The mean velocity is that of the middle of the interval.
  const double speed_change = kAcceleration * seconds / 2.0, rate_change = kTurnAcceleration * seconds / 2.0;
  covariance.topLeftCorner<3, 3>().diagonal().array() += speed_change * speed_change;
  covariance.bottomRightCorner<3, 3>().diagonal().array() += rate_change * rate_change;
  return covariance;
}

ros::Header header(const char* frame, Timestamp time) {
  return {ros::to_time(time), frame};
}

bool is_usable(const FrameReport& report) {
  return report.map_from_body && report.health.verdict != Verdict::untrusted;
}

// Adds the figures, those of parts as "part.key". Null is left out.
void add_values(const std::string& prefix, const nlohmann::ordered_json& figures, std::vector<ros::KeyValue>& values) {
  for (const auto& [key, figure] : figures.items()) {
    if (figure.is_object()) {
      add_values(prefix + key + ".", figure, values);
    } else if (const auto text = expand(figure.is_number() ? "{figure:.6g}" : "{figure}", {{"figure", figure}})) {
      values.push_back({prefix + key, *text});
    }
  }
}

void put(std::vector<std::uint8_t>& bytes, const void* value, std::size_t size) {
  const std::size_t begin = bytes.size();
  bytes.resize(begin + size);
  std::memcpy(bytes.data() + begin, value, size);
}

}  // namespace

ros::Pose ros_pose(const Pose& parent_from_child) {
  const Eigen::Vector3d& position = parent_from_child.translation;
  return {{position.x(), position.y(), position.z()}, ros_rotation(parent_from_child.rotation)};
}

ros::TransformStamped transform_message(const ros::Header& header, const std::string& child_frame,
                                        const Pose& parent_from_child) {
  return {header, child_frame, {ros_vector(parent_from_child.translation), ros_rotation(parent_from_child.rotation)}};
}

std::array<double, 36> ros_covariance(const Matrix6& covariance_in_child, const Eigen::Quaterniond& parent_from_child) {
  Matrix6 turn = Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = parent_from_child.toRotationMatrix();
  std::array<double, 36> covariance{};
  Eigen::Map<RowMajor6>(covariance.data()) = turn * covariance_in_child * turn.transpose();
  return covariance;
}

ros::PoseWithCovarianceStamped pose_message(const ros::Header& header, const Pose& parent_from_child,
                                            const Matrix6& covariance_in_child) {
  return {header, {ros_pose(parent_from_child), ros_covariance(covariance_in_child, parent_from_child.rotation)}};
}

ros::Twist twist_between(const Pose& parent_from_before, const Pose& parent_from_after, Timestamp passed) {
  const double seconds = to_seconds(passed);
  const Eigen::Vector3d step = parent_from_after.translation - parent_from_before.translation;
  const Eigen::Vector3d turn = rotation_log(parent_from_before.rotation.conjugate() * parent_from_after.rotation);
  return {ros_vector(parent_from_after.rotation.conjugate() * step / seconds), ros_vector(turn / seconds)};
}

OdometrySample odometry_sample(const FrameReport& report, const Pose& odom_from_base) {
  OdometrySample sample{report.time, odom_from_base, report.odometry_covariance};
  const bool is_smaller = is_known(report.covariance) &&
                          position_variance(report.covariance) < position_variance(sample.covariance) &&
                          rotation_variance(report.covariance) < rotation_variance(sample.covariance);
  if (report.map_from_body && is_smaller) sample.covariance = report.covariance;
  return sample;
}

ros::TwistWithCovariance twist_message(const std::optional<OdometrySample>& before, const OdometrySample& now) {
  ros::TwistWithCovariance message;
  Matrix6 covariance = kUnknownVariance * Matrix6::Identity();
  if (before && now.time > before->time) {
    message.twist = twist_between(before->odom_from_base, now.odom_from_base, now.time - before->time);
    if (is_known(before->covariance) && is_known(now.covariance)) covariance = twist_covariance(*before, now);
  }
  message.covariance = ros_covariance(covariance, Eigen::Quaterniond::Identity());
  return message;
}

std::vector<ros::KeyValue> health_values(const FrameReport& report) {
  nlohmann::ordered_json figures = {{"state", to_string(report.state)}};
  if (!report.map.empty()) figures["map"] = report.map;
  figures.update(health_json(report.health));
  figures.update({{"features", report.features},
                  {"matches", report.matches},
                  {"inliers", report.inliers},
                  {"track_seconds", report.track_seconds}});
  std::vector<ros::KeyValue> values;
  add_values("", figures, values);
  return values;
}

std::byte diagnostic_level(Verdict verdict) {
  switch (verdict) {
    case Verdict::trusted:
      return ros::DiagnosticStatus::kOk;
    case Verdict::degraded:
      return ros::DiagnosticStatus::kWarn;
    case Verdict::untrusted:
      break;
  }
  return ros::DiagnosticStatus::kError;
}

std::string verdict_and_doubt(const Health& health) {
  std::string text(to_string(health.verdict));
  if (health.doubt != DistrustReason::none) text.append(": ").append(to_string(health.doubt));
  return text;
}

ros::TFMessage ros_transforms(const FrameReport& report) {
  ros::TFMessage message;
  if (!report.odometry_from_body) return message;
  if (is_usable(report)) {
    const Pose map_from_odometry = *report.map_from_body * inverse(*report.odometry_from_body);
    message.transforms.push_back(transform_message(header(kMapFrame, report.time), kOdometryFrame, map_from_odometry));
  }
  message.transforms.push_back(
      transform_message(header(kOdometryFrame, report.time), kBodyFrame, *report.odometry_from_body));
  return message;
}

ros::Odometry ros_odometry(const FrameReport& report, const std::optional<OdometrySample>& before,
                           const OdometrySample& now) {
  const ros::Header stamped = header(kOdometryFrame, report.time);
  return {stamped, kBodyFrame, pose_message(stamped, now.odom_from_base, report.odometry_covariance).pose,
          twist_message(before, now)};
}

std::optional<ros::PoseWithCovarianceStamped> ros_map_pose(const FrameReport& report) {
  if (!is_usable(report)) return std::nullopt;
  return pose_message(header(kMapFrame, report.time), *report.map_from_body, report.covariance);
}

ros::DiagnosticArray ros_diagnostics(int number_of_frame, const PlayedFrame& frame) {
  ros::DiagnosticStatus status{ros::DiagnosticStatus::kStale, "byre: localisation", "no image", "camera", {}};
  if (frame.report) {
    status.level = diagnostic_level(frame.report->health.verdict);
    status.message = verdict_and_doubt(frame.report->health);
    status.values = health_values(*frame.report);
  }
  status.values.push_back({"frame", std::to_string(number_of_frame)});
  status.values.push_back({"keyframes", std::to_string(frame.keyframes)});
  status.values.push_back({"map_points", std::to_string(frame.points)});
  return {header("", frame.time), {std::move(status)}};
}

ros::Path ros_path(const Trajectory& trajectory, Timestamp time) {
  ros::Path path{header(kMapFrame, time), {}};
  for (const StampedPose& sample : trajectory) {
    path.poses.push_back({header(kMapFrame, sample.time), ros_pose(sample.world_from_body)});
  }
  return path;
}

ros::PointCloud2 ros_cloud(const MapGraph& map, Timestamp time) {
  constexpr std::uint32_t kStep = 20;
  ros::PointCloud2 cloud{header(kMapFrame, time), 1, 0, {{"x", 0}, {"y", 4}, {"z", 8}, {"intensity", 12}}};
  cloud.point_fields.push_back({"observations", 16, ros::PointField::kUint32, 1});
  for (const PointId id : map.point_ids()) {
    const MapPoint& point = *map.find_point(id);
    const Eigen::Vector3f position = point.position_in_world.cast<float>();
    const auto grey = static_cast<float>(grey_of(map, point).value_or(kUnknownGrey));
    const auto observations = static_cast<std::uint32_t>(map.observations(id).size());
    put(cloud.data, position.data(), 3 * sizeof(float));
    put(cloud.data, &grey, sizeof(grey));
    put(cloud.data, &observations, sizeof(observations));
    ++cloud.width;
  }
  cloud.point_step = kStep;
  cloud.row_step = kStep * cloud.width;
  cloud.is_dense = true;
  return cloud;
}

ros::TFMessage ros_camera_extrinsics(const Calibration& calibration, Timestamp time) {
  ros::TFMessage mounts{{transform_message(header(kBodyFrame, time), kLeftFrame, calibration.body_from_left)}};
  if (calibration.right) {
    const Pose left_from_right = inverse(calibration.right->right_from_left);
    mounts.transforms.push_back(transform_message(header(kLeftFrame, time), kRightFrame, left_from_right));
  }
  return mounts;
}

namespace {

// Model and number of coefficients. Models that ROS does not define keep their name.
std::pair<std::string, int> ros_lens(const Camera& camera) {
  const auto& d = camera.distortion;
  switch (camera.model) {
    case CameraModel::pinhole:
    case CameraModel::radial_tangential:
      return {"plumb_bob", 5};
    case CameraModel::equidistant:
      return {"equidistant", 4};
    case CameraModel::rational:
      return {"rational_polynomial", std::all_of(d.begin() + 8, d.end(), [](double k) { return k == 0.0; }) ? 8 : 14};
    case CameraModel::unified:
    case CameraModel::extended_unified:
    case CameraModel::double_sphere:
    case CameraModel::field_of_view:
    case CameraModel::thin_prism_fisheye:
      break;
  }
  return {std::string(to_string(camera.model)), 8};
}

}  // namespace

ros::CameraInfo ros_camera_info(const Camera& camera, const std::string& frame, Timestamp time) {
  ros::CameraInfo info{.header = header(frame.c_str(), time),
                       .height = static_cast<std::uint32_t>(camera.height),
                       .width = static_cast<std::uint32_t>(camera.width)};
  const auto [model, count] = ros_lens(camera);
  info.distortion_model = model;
  info.d.assign(camera.distortion.begin(), camera.distortion.begin() + count);
  info.k = {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0};
  info.r = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.p = {camera.fx, 0.0, camera.cx, 0.0, 0.0, camera.fy, camera.cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

ros::Image ros_image(const Image& image, const std::string& frame, Timestamp time) {
  const auto width = static_cast<std::uint32_t>(image.width);
  return {
      header(frame.c_str(), time), static_cast<std::uint32_t>(image.height), width, "mono8", 0, width, image.pixels};
}

}  // namespace byre
