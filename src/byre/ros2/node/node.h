#pragma once

#include "byre/io/recording/stamp_clock.h"
#include "byre/ros2/dds/participant.h"
#include "byre/ros2/dds/ros_graph.h"
#include "byre/ros2/fleet/fleet_link.h"
#include "byre/ros2/node/calibration_source.h"
#include "byre/ros2/node/camera_monitor.h"
#include "byre/ros2/node/image_message.h"
#include "byre/ros2/node/image_pairs.h"
#include "byre/ros2/node/input_monitor.h"
#include "byre/ros2/node/motion_input.h"
#include "byre/ros2/node/node_config.h"
#include "byre/ros2/node/node_outputs.h"
#include "byre/ros2/node/node_services.h"
#include "byre/ros2/node/process.h"
#include "byre/ros2/node/robot_frames.h"
#include "byre/ros2/node/slam_runner.h"
#include "byre/viewer/web/live_topics.h"
#include "byre/viewer/web/status_site.h"
#include "byre/viewer/web/web_server.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// ROS 2 node that tracks images from topics, docs/reference/ros2.md. One thread runs it; DDS and mapping have their
// own.
class Node {
 public:
  // log: receives one line per event. Throws InputError for unusable files, and std::runtime_error for errors of DDS.
  Node(const NodeConfig& config, const RosNetwork& network, const std::string& cyclone_settings, NodeLog log);

  // Runs until should_stop returns true, then saves the map if a file is configured. Throws InputError if that fails.
  void run(const std::function<bool()>& should_stop);

 private:
  using Pairs = ImagePairs<Message>;

  void take_images(Timestamp now);
  void start();
  void take_calibration(Timestamp now);
  bool is_waiting_for_wheels(Timestamp now);
  void publish_grid_of_map();
  void take_transforms(Timestamp now);
  void log_transforms(Timestamp now);
  void watch_images(const TopicQos& qos);
  void watch_odometry(const TopicQos& qos);
  void watch_outputs();
  void publish_cameras(const std::string& left_frame, const std::string& right_frame);
  std::string rival_of_cameras() const;
  void check_inputs(Timestamp now);
  void take_requests(Timestamp now);
  Outcome answer(const std::string& request, const std::function<std::string()>& done);
  Outcome execute(const std::string& command);
  Outcome take_hint(const ros::PoseWithCovarianceStamped& hint);
  std::string compare(const ros::PoseWithCovarianceStamped& message);
  ReceivedImage decoded(const Message& message, const std::string& topic) const;
  ReceivedDepth decoded_depth(const Message& message) const;
  std::optional<ReceivedDepth> usable_depth(const Message& message, Timestamp now);
  void note_depth_format(const Message& message, Timestamp now);
  void process(const Pairs::Pair& pair);
  void publish(const ReceivedImage& left, const FrameReport& report);
  void publish_state(Timestamp now);
  void publish_fleet(Timestamp now);
  void log_registry(const ros::DiagnosticStatus& status);
  void publish_status(const ros::DiagnosticStatus& localisation, const ros::DiagnosticStatus& cameras);
  ros::DiagnosticStatus localisation() const;
  void restart();

  NodeConfig config_;  // constant after construction
  NodeLog log_;        // constant after construction
  Participant participant_;
  GraphAnnouncement graph_;
  InputMonitor inputs_;
  CalibrationSource calibration_source_;
  SlamRunner runner_;
  std::shared_ptr<LiveTopics> watchers_;  // null without a web server
  NodeOutputs outputs_;
  std::optional<Subscriber> left_, second_, command_, initial_pose_, tf_, tf_static_;
  InputMonitor::Id left_input_ = 0, second_input_ = 0, odometry_input_ = 0;  // second: only with a topic
  std::optional<NodeServices> services_;                                     // empty if services are disabled
  MotionInput motion_;
  Pairs pairs_;
  StampClock clock_;
  CameraMonitor monitor_;
  PoseFrames pose_frames_;
  RobotFrames robot_frames_;
  ServiceManager manager_;
  std::shared_ptr<StatusBoard> board_ = std::make_shared<StatusBoard>();
  std::optional<FleetLink> fleet_;       // empty without a fleet interface
  std::optional<WebServer> web_server_;  // uses board_ and watchers_

  std::optional<Calibration> calibration_;   // empty until available
  std::optional<Timestamp> calibrated_at_;   // time since which the calibration is available
  bool waits_for_wheels_ = false;            // with a calibration
  std::string left_frame_;                   // frame of the left images; empty before the first one
  std::optional<DepthFormat> depth_format_;  // format at the calibration; empty before a depth image
  std::vector<std::string> camera_frames_;   // empty until the cameras are published
  std::optional<FrameReport> last_report_;
  std::optional<Pose> map_from_body_;  // last published pose
  Timestamp last_image_time_{};
  std::string last_diagnosis_;
  std::optional<Timestamp> without_odometry_since_;  // no odom -> base of its owner for the images since then
  std::string last_transforms_;                      // last reported state of the transforms
  std::string last_registry_;                        // last reported state of the registry
  std::string last_fault_;                           // last reported fault of the calibration
  Timestamp last_checked_{};                         // time of the last check of the inputs
  std::optional<Timestamp> last_odometry_;           // arrival of the last odom -> base of its owner
  Timestamp last_published_{};                       // time of the last diagnostics
  Timestamp last_slow_published_{};                  // time of the last path and points
  int arrived_at_last_keepalive_ = 0;
  int frames_ = 0;
  int frames_at_last_keepalive_ = 0;
};

}  // namespace byre
