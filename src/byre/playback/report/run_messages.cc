#include "byre/playback/report/run_messages.h"

#include <string>
#include <utility>

namespace byre {
namespace {

using ros::topic_of;
using std::chrono::steady_clock;

constexpr Timestamp kMapInterval = std::chrono::seconds(10);
constexpr Timestamp kWatchedMapInterval = std::chrono::seconds(1);
constexpr int kTimeBetweenMaps = 500;  // pause after a map message, as a multiple of the time it took
constexpr double kPathStep = 0.1;      // metres between poses of the path message

}  // namespace

RunMessages::RunMessages(ros::MessageSink& sink, const Calibration& calibration, const RunMessageOptions& options)
    : calibration_(calibration), sink_(sink), is_watched_(options.is_watched) {
  constexpr auto kLatched = ros::Durability::latched;
  topics_.transforms = sink_.add(topic_of<ros::TFMessage>("/tf"));
  topics_.mounts = sink_.add(topic_of<ros::TFMessage>("/tf_static", kLatched));
  topics_.odometry = sink_.add(topic_of<ros::Odometry>("/byre/odometry"));
  topics_.pose = sink_.add(topic_of<ros::PoseWithCovarianceStamped>("/byre/pose"));
  topics_.path = sink_.add(topic_of<ros::Path>("/byre/path", kLatched));
  topics_.diagnostics = sink_.add(topic_of<ros::DiagnosticArray>("/diagnostics"));
  topics_.events = sink_.add(topic_of<ros::String>("/byre/events"));
  topics_.points = sink_.add(topic_of<ros::PointCloud2>("/byre/points", kLatched));
  topics_.offline_points = sink_.add(topic_of<ros::PointCloud2>("/byre/offline_points", kLatched));
  if (!options.with_images) return;
  left_ = add_camera("/left");
  if (calibration_.right) right_ = add_camera("/right");
}

RunMessages::CameraTopics RunMessages::add_camera(const std::string& name) {
  return {sink_.add(topic_of<ros::Image>(name + "/image_raw")),
          sink_.add(topic_of<ros::CameraInfo>(name + "/camera_info"))};
}

void RunMessages::note(const RunView& view) {
  const bool is_map_new = view.frame.report->has(SessionEvent::map_changed);
  if (is_map_new) path_.clear();
  if (!std::exchange(has_begun_, true) || is_map_new) note_first(view);
  note_report(frames_++, view.frame);
  if (left_) note_images(view.images);
  note_map(view.frame.time, view.session.map().online());
  last_time_ = view.frame.time;
}

void RunMessages::note_unreadable(const PlayedFrame& frame) {
  note_diagnostics(frames_++, frame);
  last_time_ = frame.time;
}

void RunMessages::note_first(const RunView& view) {
  const Timestamp time = view.frame.time;
  sink_.put_message(topics_.mounts, time, ros_camera_extrinsics(calibration_, time));
  if (const MapGraph* const offline = view.session.map().offline()) {
    sink_.put_message(topics_.offline_points, time, ros_cloud(*offline, time));
  }
}

void RunMessages::note_report(int number, const PlayedFrame& frame) {
  const Timestamp time = frame.time;
  note_diagnostics(number, frame);
  note_events(number, frame);
  const FrameReport& report = *frame.report;
  if (sink_.is_wanted(topics_.transforms)) {
    const ros::TFMessage transforms = ros_transforms(report);
    if (!transforms.transforms.empty()) sink_.put_message(topics_.transforms, time, transforms);
  }
  if (report.odometry_from_body) {
    const OdometrySample sample = odometry_sample(report, *report.odometry_from_body);
    if (sink_.is_wanted(topics_.odometry)) {
      sink_.put_message(topics_.odometry, time, ros_odometry(report, odometry_, sample));
    }
    odometry_ = sample;
  } else {
    odometry_.reset();
  }
  note_pose(report);
}

void RunMessages::note_diagnostics(int number, const PlayedFrame& frame) {
  if (!sink_.is_wanted(topics_.diagnostics)) return;
  sink_.put_message(topics_.diagnostics, frame.time, ros_diagnostics(number, frame));
}

void RunMessages::note_events(int number, const PlayedFrame& frame) {
  events_.note(number, frame);
  std::istringstream lines(event_text_.str());
  event_text_.str("");
  for (std::string line; std::getline(lines, line);) sink_.put_message(topics_.events, frame.time, ros::String{line});
}

void RunMessages::note_pose(const FrameReport& report) {
  const auto pose = ros_map_pose(report);
  if (!pose) return;
  if (sink_.is_wanted(topics_.pose)) sink_.put_message(topics_.pose, report.time, *pose);
  const Eigen::Vector3d& position = report.map_from_body->translation;
  if (path_.empty() || (position - path_.back().world_from_body.translation).norm() >= kPathStep) {
    path_.push_back({report.time, *report.map_from_body});
  }
}

void RunMessages::note_map(Timestamp time, const MapGraph& online) {
  const bool wants_path = sink_.is_wanted(topics_.path);
  const bool wants_points = sink_.is_wanted(topics_.points);
  if (!wants_path && !wants_points) return;
  if (map_time_ && time - *map_time_ < (is_watched_ ? kWatchedMapInterval : kMapInterval)) return;
  const auto begin = steady_clock::now();
  if (is_watched_ && begin < map_pause_) return;
  if (wants_path) sink_.put_message(topics_.path, time, ros_path(path_, time));
  if (wants_points) sink_.put_message(topics_.points, time, ros_cloud(online, time));
  map_time_ = time;
  const auto end = steady_clock::now();
  map_pause_ = end + kTimeBetweenMaps * (end - begin);
}

void RunMessages::note_images(const ImageFrame& images) {
  note_image(*left_, images.left, calibration_.left, kLeftFrame, images.time);
  if (!right_ || !images.right) return;
  note_image(*right_, *images.right, calibration_.right->camera, kRightFrame, images.time);
}

void RunMessages::note_image(const CameraTopics& topics, const Image& image, const Camera& camera, const char* frame,
                             Timestamp time) {
  if (sink_.is_wanted(topics.image)) sink_.put_message(topics.image, time, ros_image(image, frame, time));
  if (sink_.is_wanted(topics.info)) sink_.put_message(topics.info, time, ros_camera_info(camera, frame, time));
}

void RunMessages::finish(const RunResult& run) {
  if (!has_begun_) return;
  sink_.put_message(topics_.path, last_time_, ros_path(run.final, last_time_));
  sink_.put_message(topics_.points, last_time_, ros_cloud(run.stored.map, last_time_));
}

}  // namespace byre
