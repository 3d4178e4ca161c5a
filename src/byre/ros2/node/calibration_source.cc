#include "byre/ros2/node/calibration_source.h"

#include "byre/base/printable.h"
#include "byre/calibration_file.h"
#include "byre/io/recording/bag_image.h"
#include "byre/io/recording/bag_topics.h"
#include "byre/io/recording/camera_info.h"
#include "byre/io/recording/frame_selection.h"
#include "byre/ros2/dds/ros_network.h"
#include "byre/ros2/node/message_parsing.h"

namespace byre {
namespace {

constexpr TopicQos kInfoQos{.is_reliable = false, .depth = 5, .max_bytes = kMaxBytesWithoutImage};
constexpr TopicQos kFixedFramesQos{.is_latched = true, .depth = 100, .max_bytes = kMaxBytesWithoutImage};
constexpr std::size_t kShownOfFrame = 100;  // bytes of a frame id in a message

}  // namespace

CalibrationSource::CalibrationSource(const NodeConfig& config, GraphAnnouncement& graph, InputMonitor& monitor)
    : config_(config), monitor_(monitor) {
  const bool uses_tf = config.extrinsics_source() == ExtrinsicsSource::tf;
  if (config.has_depth()) depth_of_file_ = read_node_depth_camera(config);
  const bool uses_depth_info = config.has_depth() && !depth_of_file_ && !config.depth_info.empty();
  if (uses_tf || uses_depth_info) {
    tf_static_ = graph.subscribe(config.topic(config.tf_static), message_type<ros::TFMessage>(), kFixedFramesQos);
  }
  if (uses_tf) {
    tf_input_ = watch_frames(
        "transform from " + config.base_frame + " to the frame of the left images",
        "the transforms received do not connect these frames; correct the robot description, or frames.base");
  }
  if (uses_depth_info) {
    subscribe(depth_info_, "camera info of the depth camera", config.depth_info, graph);
    depth_tf_input_ =
        watch_frames("transform from the frame of the left images to that of the depth camera info",
                     "the transforms received do not connect these frames; publish it, or set images.depth to depth "
                     "registered to the left images");
    monitor.set_needed(depth_tf_input_, false);
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

InputMonitor::Id CalibrationSource::watch_frames(const std::string& name, const std::string& remedy) {
  WatchedInput input{name, config_.topic(config_.tf_static), {message_type<ros::TFMessage>().name}, kFixedFramesQos};
  input.is_once = true;
  input.matched = [this] { return tf_static_->publishers(); };
  input.detail = [this, remedy] { return has_frames_ ? remedy : ""; };
  return monitor_.add(std::move(input));
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
  if (config_.extrinsics_source() != ExtrinsicsSource::tf) return;
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

// With its own camera info, or registered to the left camera; empty while the first is missing.
std::optional<DepthCamera> CalibrationSource::placed_depth_camera(const Camera& left, const std::string& left_frame,
                                                                  const DepthFormat& format) {
  const std::string topic = config_.topic(config_.depth);
  const bool is_named_registered = is_registered({topic, "", ""});
  if (!depth_info_) {
    if (is_named_registered || frame_without_slash(format.frame) == frame_without_slash(left_frame))
      return DepthCamera{};
    throw InputError(topic,
                     "has the frame '" + printable(format.frame, kShownOfFrame) + "', not that of the left images, '" +
                         printable(left_frame, kShownOfFrame) + "'",
                     "set images.depth to depth registered to the left images, or calibration.depth_info");
  }
  if (!depth_info_->last) {
    missing_input_ = "camera info on " + depth_info_->topic;
    return std::nullopt;
  }
  const CameraInfoWithSource own{*depth_info_->last, depth_info_->topic, is_rectified({topic, "", ""})};
  const auto depth = depth_camera_of(own, is_named_registered, left, left_frame, frames_);
  monitor_.set_needed(depth_tf_input_, !depth);
  if (!depth) {
    missing_input_ = config_.topic(config_.tf_static) + " from the frame of the left images, " +
                     printable(left_frame, kShownOfFrame) + ", to that of " + depth_info_->topic + ", " +
                     printable(own.info.header.frame_id, kShownOfFrame);
  }
  return depth;
}

std::optional<DepthCamera> CalibrationSource::depth_camera(const Camera& left, const std::string& left_frame,
                                                           const std::optional<DepthFormat>& format) {
  take_info(depth_info_);
  const std::string topic = config_.topic(config_.depth);
  if (!format || left_frame.empty()) {
    missing_input_ = format ? "images on " + config_.topic(config_.left) : "depth images on " + topic;
    return std::nullopt;
  }
  auto depth = depth_of_file_ ? depth_of_file_ : placed_depth_camera(left, left_frame, *format);
  if (!depth) return std::nullopt;
  if (format->is_in_metres) depth->units_per_metre = kUnitsOfMetres;
  if (!format->is_in_metres && !depth_of_file_) depth->units_per_metre = kUnitsOfMillimetres;
  require_calibrated_size(format->width, format->height, depth->camera.value_or(left), topic);
  return depth;
}

std::optional<Calibration> CalibrationSource::take(const std::string& left_frame,
                                                   const std::optional<DepthFormat>& depth) {
  if (tf_static_) take_frames(left_frame);
  std::optional<Calibration> calibration = cameras();
  if (!calibration) return std::nullopt;
  if (config_.has_depth()) {
    calibration->depth = depth_camera(calibration->left, left_frame, depth);
    if (!calibration->depth) return std::nullopt;
  }
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
