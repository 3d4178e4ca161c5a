#pragma once

#include "byre/io/recording/static_frames.h"
#include "byre/ros2/dds/participant.h"
#include "byre/ros2/dds/ros_graph.h"
#include "byre/ros2/node/node_config.h"

#include <optional>
#include <string>

namespace byre {

// Calibration of a node's cameras, from a file or from camera info, with their extrinsics on the robot. Body frame: the
// base frame.
class CalibrationSource {
 public:
  // Throws InputError if the calibration file cannot be read or lacks the right camera.
  CalibrationSource(const NodeConfig& config, GraphAnnouncement& graph);

  // Processes received messages; empty while any are missing. left_frame: frame of the left images; empty before the
  // first one. Throws InputError for unusable camera info.
  std::optional<Calibration> take(const std::string& left_frame);

  const std::string& missing_input() const { return missing_input_; }  // missing input, as text

 private:
  std::optional<Calibration> cameras();

  NodeConfig config_;  // constant after construction
  std::optional<Subscriber> left_info_;
  std::optional<Subscriber> right_info_;
  std::optional<Subscriber> tf_static_;
  std::optional<ros::CameraInfo> left_;
  std::optional<ros::CameraInfo> right_;
  StaticFrames frames_;
  std::optional<Calibration> cameras_;  // empty until received
  std::string missing_input_;
};

}  // namespace byre
