#include "byre/assessment/run_record.h"

#include "byre/assessment/ros_report.h"

#include <string>
#include <utility>

namespace byre {
namespace {

constexpr Timestamp kMapInterval = std::chrono::seconds(10);
constexpr Timestamp kFlushInterval = std::chrono::seconds(1);
constexpr double kPathStep = 0.1;  // metres between poses of the path

// Whether so much time has passed since then, which it is set to.
bool is_due(std::optional<Timestamp>& last, Timestamp now, Timestamp interval) {
  if (last && now - *last < interval) return false;
  last = now;
  return true;
}

}  // namespace

RunRecord::RunRecord(McapWriter writer, const Calibration& calibration, bool with_images)
    : calibration_(calibration), writer_(std::move(writer)) {
  topics_.transforms = writer_.add_topic<ros::TFMessage>("/tf");
  topics_.mounts = writer_.add_topic<ros::TFMessage>("/tf_static", Durability::kept);
  topics_.odometry = writer_.add_topic<ros::Odometry>("/odometry");
  topics_.pose = writer_.add_topic<ros::PoseWithCovarianceStamped>("/pose");
  topics_.path = writer_.add_topic<ros::Path>("/path", Durability::kept);
  topics_.diagnostics = writer_.add_topic<ros::DiagnosticArray>("/diagnostics");
  topics_.events = writer_.add_topic<ros::String>("/events");
  topics_.points = writer_.add_topic<ros::PointCloud2>("/map_points", Durability::kept);
  topics_.offline_points = writer_.add_topic<ros::PointCloud2>("/offline_map_points", Durability::kept);
  if (!with_images) return;
  left_ = add_camera("/left");
  if (calibration_.right) right_ = add_camera("/right");
}

RunRecord::CameraTopics RunRecord::add_camera(const std::string& name) {
  return {writer_.add_topic<ros::Image>(name + "/image_raw"),
          writer_.add_topic<ros::CameraInfo>(name + "/camera_info")};
}

void RunRecord::note(const RunView& view) {
  const Timestamp time = view.frame.time;
  if (!map_time_) note_first(view);
  note_report(frames_++, view.frame);
  if (left_) note_images(view.images);
  if (is_due(map_time_, time, kMapInterval)) {
    writer_.write(topics_.path, time, ros_path(path_, time));
    writer_.write(topics_.points, time, ros_cloud(view.session.map().online(), time));
  }
  if (is_due(flush_time_, time, kFlushInterval)) writer_.flush();
  last_time_ = time;
}

void RunRecord::note_unread(const MappedFrame& frame) {
  writer_.write(topics_.diagnostics, frame.time, ros_diagnostics(frames_++, frame));
  last_time_ = frame.time;
}

void RunRecord::note_first(const RunView& view) {
  const Timestamp time = view.frame.time;
  writer_.write(topics_.mounts, time, ros_mounts(calibration_, time));
  if (const Map* const offline = view.session.map().offline()) {
    writer_.write(topics_.offline_points, time, ros_cloud(*offline, time));
  }
}

void RunRecord::note_report(int number, const MappedFrame& frame) {
  const Timestamp time = frame.time;
  writer_.write(topics_.diagnostics, time, ros_diagnostics(number, frame));
  events_.note(number, frame);
  std::istringstream lines(event_text_.str());
  event_text_.str("");
  for (std::string line; std::getline(lines, line);) writer_.write(topics_.events, time, ros::String{line});
  const FrameReport& report = *frame.report;
  const ros::TFMessage transforms = ros_transforms(report);
  if (!transforms.transforms.empty()) writer_.write(topics_.transforms, time, transforms);
  if (report.odometry_from_body) {
    writer_.write(topics_.odometry, time, ros_odometry(report, odometry_));
    odometry_ = StampedPose{time, *report.odometry_from_body};
  }
  if (const auto pose = ros_map_pose(report)) {
    writer_.write(topics_.pose, time, *pose);
    const Eigen::Vector3d& position = report.map_from_body->translation;
    if (path_.empty() || (position - path_.back().world_from_body.translation).norm() >= kPathStep) {
      path_.push_back({time, *report.map_from_body});
    }
  }
}

void RunRecord::note_images(const ImageFrame& images) {
  write_image(*left_, images.left, kLeftFrame, images.time);
  writer_.write(left_->info, images.time, ros_camera_info(calibration_.left, kLeftFrame, images.time));
  if (!right_ || !images.right) return;
  write_image(*right_, *images.right, kRightFrame, images.time);
  writer_.write(right_->info, images.time, ros_camera_info(calibration_.right->camera, kRightFrame, images.time));
}

void RunRecord::write_image(const CameraTopics& camera, const Image& image, const char* frame, Timestamp time) {
  writer_.write(camera.image, time, ros_image(image, frame, time));
}

void RunRecord::finish(const MapRun& run) {
  if (map_time_) {
    writer_.write(topics_.path, last_time_, ros_path(run.final, last_time_));
    writer_.write(topics_.points, last_time_, ros_cloud(run.map, last_time_));
  }
  writer_.close();
}

}  // namespace byre
