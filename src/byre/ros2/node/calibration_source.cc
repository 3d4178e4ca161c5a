#include "byre/ros2/node/calibration_source.h"

#include "byre/calibration_file.h"
#include "byre/io/recording/camera_info.h"
#include "byre/ros2/dds/ros_names.h"
#include "byre/ros2/node/message_parsing.h"

#include <utility>

namespace byre {
namespace {

template <ros::Message T>
void take_last(std::optional<Subscriber>& subscriber, const std::string& topic, std::optional<T>& last) {
  if (!subscriber) return;
  for (const Message& message : subscriber->take()) {
    if (auto parsed = parsed_message<T>(message, topic)) last = std::move(parsed);
  }
}

}  // namespace

CalibrationSource::CalibrationSource(const NodeConfig& config, GraphAnnouncement& graph) : config_(config) {
  if (config.extrinsics_source() == ExtrinsicsSource::tf) {
    tf_static_ = graph.subscribe(config.topic(config.tf_static), message_type<ros::TFMessage>(),
                                 {.is_latched = true, .depth = 100, .max_bytes = kMaxBytesWithoutImage});
  }
  if (config.calibration) {
    cameras_ = read_calibration(*config.calibration);
    require_cameras(*cameras_, config);
    if (!config.has_right()) cameras_->right.reset();
    return;
  }
  const TopicQos qos{.is_reliable = false, .depth = 5, .max_bytes = kMaxBytesWithoutImage};
  left_info_ = graph.subscribe(config.topic(config.left_info), message_type<ros::CameraInfo>(), qos);
  if (config.has_right()) {
    right_info_ = graph.subscribe(config.topic(config.right_info), message_type<ros::CameraInfo>(), qos);
  }
}

std::optional<Calibration> CalibrationSource::cameras() {
  if (cameras_) return cameras_;
  take_last(left_info_, config_.topic(config_.left_info), left_);
  take_last(right_info_, config_.topic(config_.right_info), right_);
  if (!left_) missing_input_ = "camera info on " + config_.topic(config_.left_info);
  if (left_ && config_.has_right() && !right_) missing_input_ = "camera info on " + config_.topic(config_.right_info);
  if (!left_ || (config_.has_right() && !right_)) return std::nullopt;
  // Each is processed once, as drivers repeat them.
  const auto placed = [&](std::optional<ros::CameraInfo>& info, const std::string& topic) {
    return CameraInfoWithSource{*std::exchange(info, std::nullopt), config_.topic(topic), config_.is_rectified};
  };
  const CameraInfoWithSource left = placed(left_, config_.left_info);
  Calibration calibration{camera_of(left), std::nullopt, {}};
  if (config_.has_right()) calibration.right = partner_of(left, placed(right_, config_.right_info), frames_);
  cameras_ = calibration;
  return cameras_;
}

std::optional<Calibration> CalibrationSource::take(const std::string& left_frame) {
  if (tf_static_) {
    for (const Message& message : tf_static_->take()) {
      if (const auto parsed = parsed_message<ros::TFMessage>(message, config_.tf_static)) frames_.take(*parsed);
    }
  }
  std::optional<Calibration> calibration = cameras();
  if (!calibration) return std::nullopt;
  if (config_.extrinsics_source() == ExtrinsicsSource::camera) calibration->body_from_left = {};
  if (config_.extrinsics_source() != ExtrinsicsSource::tf) return calibration;
  const auto base_from_left = frames_.between(config_.base_frame, left_frame);
  if (!base_from_left) {
    missing_input_ = config_.topic(config_.tf_static) + " from " + config_.base_frame +
                     " to the frame of the left images" + (left_frame.empty() ? "" : ", " + left_frame);
    return std::nullopt;
  }
  calibration->body_from_left = *base_from_left;
  return calibration;
}

}  // namespace byre
