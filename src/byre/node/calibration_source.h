#pragma once

#include "byre/dataset/static_frames.h"
#include "byre/dds/participant.h"
#include "byre/dds/ros_graph.h"
#include "byre/node/node_config.h"

#include <optional>
#include <string>

namespace byre {

// Where the calibration of a node's cameras comes from: a file, or camera info; and how they sit on the robot. Its body
// is the base frame.
class CalibrationSource {
 public:
  // Throws InputError for a calibration file that cannot be read or lacks the right camera.
  CalibrationSource(const NodeConfig& config, Participant& participant, GraphAnnouncement& graph);

  // Takes what came. left_frame: of the images; empty while none came. Empty while something is missing. Throws
  // InputError for camera info that cannot be used.
  std::optional<Calibration> take(const std::string& left_frame);

  const std::string& awaited() const { return awaited_; }  // what is missing, for people

 private:
  std::optional<Calibration> cameras();

  NodeConfig config_;  // constant after construction
  std::optional<Subscriber> left_info_;
  std::optional<Subscriber> right_info_;
  std::optional<Subscriber> tf_static_;
  std::optional<ros::CameraInfo> left_;
  std::optional<ros::CameraInfo> right_;
  StaticFrames frames_;
  std::optional<Calibration> cameras_;  // as soon as it is known
  std::string awaited_;
};

}  // namespace byre
