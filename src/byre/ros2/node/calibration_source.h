#pragma once

#include "byre/io/recording/static_frames.h"
#include "byre/ros2/dds/participant.h"
#include "byre/ros2/dds/ros_graph.h"
#include "byre/ros2/node/input_monitor.h"
#include "byre/ros2/node/node_config.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace byre {

// Format of depth images, by one of them.
struct DepthFormat {
  std::string frame;
  int width = 0;
  int height = 0;
  bool is_in_metres = false;  // see ReceivedDepth
};

// Calibration of a node's cameras, from a file or from camera info, with their extrinsics on the robot. Body frame: the
// base frame.
class CalibrationSource {
 public:
  // Its topics are added to the monitor, which outlives this. Throws InputError if the calibration file cannot be read
  // or lacks the right camera.
  CalibrationSource(const NodeConfig& config, GraphAnnouncement& graph, InputMonitor& monitor);
  CalibrationSource(const CalibrationSource&) = delete;  // the monitor refers to it
  CalibrationSource& operator=(const CalibrationSource&) = delete;

  // Processes received messages; empty while any are missing. left_frame: frame of the left images; empty before the
  // first one. depth: empty before the first depth image. Throws InputError for unusable camera info, and for depth
  // images that are not those of the calibration.
  std::optional<Calibration> take(const std::string& left_frame, const std::optional<DepthFormat>& depth);

  const std::string& missing_input() const { return missing_input_; }  // missing input, as text
  // Doubts about the calibration since the previous call.
  std::vector<std::string> take_warnings() { return std::exchange(warnings_, {}); }

 private:
  struct Info {
    Subscriber subscriber;
    std::string topic;
    InputMonitor::Id input = 0;
    std::optional<ros::CameraInfo> last{};
  };
  InputMonitor::Id watch_frames(const std::string& name, const std::string& remedy);
  void subscribe(std::optional<Info>& info, const char* name, const std::string& topic, GraphAnnouncement& graph);
  void take_info(std::optional<Info>& info);
  void take_frames(const std::string& left_frame);
  std::optional<Calibration> cameras();
  std::optional<DepthCamera> depth_camera(const Camera& left, const std::string& left_frame,
                                          const std::optional<DepthFormat>& format);
  std::optional<DepthCamera> placed_depth_camera(const Camera& left, const std::string& left_frame,
                                                 const DepthFormat& format);

  NodeConfig config_;      // constant after construction
  InputMonitor& monitor_;  // outlives this
  std::optional<Info> left_info_;
  std::optional<Info> right_info_;
  std::optional<Info> depth_info_;
  std::optional<Subscriber> tf_static_;
  InputMonitor::Id tf_input_ = 0;        // watched input for tf_static_, with frames.mounting: tf
  InputMonitor::Id depth_tf_input_ = 0;  // watched input for tf_static_, with depth_info_
  StaticFrames frames_;
  bool has_frames_ = false;
  std::optional<Pose> base_from_left_;        // from frames_
  std::optional<Calibration> cameras_;        // empty until received
  std::optional<DepthCamera> depth_of_file_;  // empty without fields of it in the calibration file
  std::string missing_input_;
  std::vector<std::string> warnings_;
};

}  // namespace byre
