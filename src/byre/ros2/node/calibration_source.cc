#include "byre/ros2/node/calibration_source.h"

#include "byre/calibration_file.h"
#include "byre/io/recording/camera_info.h"
#include "byre/ros2/dds/ros_names.h"
#include "byre/ros2/node/message_parsing.h"

#include <utility>

namespace byre {
namespace {

constexpr TopicQos kInfoQos{.is_reliable = false, .depth = 5, .max_bytes = kMaxBytesWithoutImage};
constexpr TopicQos kFixedFramesQos{.is_latched = true, .depth = 100, .max_bytes = kMaxBytesWithoutImage};

}  // namespace

CalibrationSource::CalibrationSource(const NodeConfig& config, GraphAnnouncement& graph, InputMonitor& monitor)
    : config_(config), monitor_(monitor) {
  if (config.extrinsics_source() == ExtrinsicsSource::tf) {
    const std::string topic = config.topic(config.tf_static);
    const MessageType type = message_type<ros::TFMessage>();
    tf_static_ = graph.subscribe(topic, type, kFixedFramesQos);
    WatchedInput input{"transform from " + config.base_frame + " to the frame of the left images",
                       topic,
                       {type.name},
                       kFixedFramesQos};
    input.is_once = true;
    input.matched = [this] { return tf_static_->publishers(); };
    input.detail = [this] {
      return has_frames_ ? "the transforms received do not connect these frames; correct the robot description, or "
                           "frames.base"
                         : "";
    };
    tf_input_ = monitor.add(std::move(input));
  }
  if (config.calibration) {
    const CalibrationReading reading = read_node_calibration(config);
    cameras_ = reading.calibration;
    warnings_ = reading.notes;
    if (const auto fault = fault_of_base_frame(*cameras_, config)) warnings_.emplace_back(fault->what());
    if (!config.has_right()) cameras_->right.reset();
    return;
  }
  subscribe(left_info_, "camera info of the left camera", config.left_info, graph);
  if (config.has_right()) subscribe(right_info_, "camera info of the right camera", config.right_info, graph);
}

void CalibrationSource::subscribe(std::optional<Info>& info, const char* name, const std::string& topic,
                                  GraphAnnouncement& graph) {
  const std::string whole = config_.topic(topic);
  const MessageType type = message_type<ros::CameraInfo>();
  info = Info{graph.subscribe(whole, type, kInfoQos), whole};
  WatchedInput input{name, whole, {type.name}, kInfoQos};
  input.is_once = true;
  input.matched = [source = &info] { return (*source)->subscriber.publishers(); };
  info->input = monitor_.add(std::move(input));
}

void CalibrationSource::take_info(std::optional<Info>& info) {
  if (!info) return;
  for (const Message& message : info->subscriber.take()) {
    auto parsed = parsed_message<ros::CameraInfo>(message, info->topic);
    if (!parsed) continue;
    monitor_.note_arrival(info->input);
    info->last = std::move(parsed);
  }
}

void CalibrationSource::take_frames(const std::string& left_frame) {
  for (const Message& message : tf_static_->take()) {
    const auto parsed = parsed_message<ros::TFMessage>(message, config_.tf_static);
    if (!parsed) continue;
    frames_.take(*parsed);
    has_frames_ = true;
  }
  base_from_left_ = frames_.between(config_.base_frame, left_frame);
  if (base_from_left_) monitor_.note_arrival(tf_input_);
  // The images name their frame; without any these are the missing input.
  monitor_.set_needed(tf_input_, !has_frames_ || !left_frame.empty());
}

std::optional<Calibration> CalibrationSource::cameras() {
  if (cameras_) return cameras_;
  take_info(left_info_);
  take_info(right_info_);
  if (!left_info_->last) missing_input_ = "camera info on " + left_info_->topic;
  if (left_info_->last && right_info_ && !right_info_->last) missing_input_ = "camera info on " + right_info_->topic;
  if (!left_info_->last || (right_info_ && !right_info_->last)) return std::nullopt;
  // Each is processed once, as drivers repeat them.
  const auto placed = [&](Info& info) {
    return CameraInfoWithSource{*std::exchange(info.last, std::nullopt), info.topic, config_.is_rectified};
  };
  const CameraInfoWithSource left = placed(*left_info_);
  Calibration calibration{camera_of(left), std::nullopt, {}};
  if (right_info_) {
    const CameraInfoWithSource right = placed(*right_info_);
    calibration.right = partner_of(left, right, frames_);
    if (has_positive_baseline(left, right)) {
      warnings_.push_back(right.place +
                          ": the baseline in P is positive, but a right camera has a negative one; the sign is "
                          "ignored. If left and right images then do not fit, exchange images.left and images.right");
    }
  }
  cameras_ = calibration;
  return cameras_;
}

std::optional<Calibration> CalibrationSource::take(const std::string& left_frame) {
  if (tf_static_) take_frames(left_frame);
  std::optional<Calibration> calibration = cameras();
  if (!calibration) return std::nullopt;
  if (config_.extrinsics_source() == ExtrinsicsSource::camera) calibration->body_from_left = {};
  if (config_.extrinsics_source() != ExtrinsicsSource::tf) return calibration;
  if (!base_from_left_) {
    missing_input_ = config_.topic(config_.tf_static) + " from " + config_.base_frame +
                     " to the frame of the left images" + (left_frame.empty() ? "" : ", " + left_frame);
    return std::nullopt;
  }
  calibration->body_from_left = *base_from_left_;
  return calibration;
}

}  // namespace byre
