#pragma once

#include "byre/io/ros/message_sink.h"
#include "byre/io/ros/messages.h"
#include "byre/playback/report/event_log.h"
#include "byre/playback/report/ros_report.h"
#include "byre/ros2/dds/participant.h"
#include "byre/ros2/dds/ros_graph.h"
#include "byre/ros2/node/node_config.h"
#include "byre/ros2/node/robot_frames.h"
#include "byre/ros2/node/slam_runner.h"

#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <vector>

namespace byre {

// Output topics of a node. Disabled topics have no publisher.
class NodeOutputs {
 public:
  // watchers: additional sink for all messages; may be null. All arguments but the settings outlive this.
  NodeOutputs(const NodeConfig& config, GraphAnnouncement& graph, ros::MessageSink* watchers);

  // Publishes all messages of a frame. image: header of its left image. The pose is in the published map frame.
  // is_map_free: whether no other node publishes map -> odom.
  void publish_frame(const ros::Header& image, const FrameReport& report, const PoseFrames& frames, bool is_map_free);
  bool has_cameras() const { return tf_static_.has_value(); }
  // Empty frames are left out.
  void publish_cameras(const Calibration& calibration, const std::string& left_frame, const std::string& right_frame);
  // Sends received images to watchers only.
  void publish_images(Timestamp stamp, std::span<const std::byte> left, std::span<const std::byte> second);
  void publish_diagnostics(std::vector<ros::DiagnosticStatus> statuses);
  void publish_answer(const std::string& request, bool is_done, const std::string& answer);
  // Publishes the floor plan, if configured.
  void publish_plan();
  bool has_grid() const { return grid_.has_value(); }
  // Whether the occupancy grid is that of the map, or of its plan in a site.
  bool has_grid_of_map() const { return grid_ && !config_.plan; }
  // grid: in the published map frame.
  void publish_grid(ros::OccupancyGrid grid);
  // Only with subscribers.
  void publish_path(const SlamRunner& runner, Timestamp image_time);
  void publish_points(const SlamRunner& runner);
  // Begins a new run, perhaps on another map.
  void restart() {
    has_published_points_ = false;
    last_.reset();
  }

 private:
  // Topic with DDS readers and watchers.
  struct Output {
    Publisher publisher;
    std::optional<ros::MessageSink::TopicId> watched;
  };
  using OptionalOutput = std::optional<Output>;  // empty: disabled

  template <ros::Message T>
  OptionalOutput open(const std::string& topic, const TopicQos& qos);
  bool is_wanted(const OptionalOutput& output) const;
  template <ros::Message T>
  void send(OptionalOutput& output, const T& message) {
    if (output) send_bytes(*output, ros::write_message(message, ros::Encoding::cdr));
  }
  void send_bytes(Output& output, std::vector<std::byte> cdr);
  void send_text(OptionalOutput& output, const std::string& text) { send(output, ros::String{text}); }
  void publish_odometry(const ros::Header& header, const FrameReport& report, const Pose& odom_from_base);
  void publish_transforms(const ros::Header& image, const PoseFrames& frames, bool is_map_free);
  void publish_events(const FrameReport& report);
  static Timestamp wall_time();
  ros::Header in_map(const ros::Header& image) const;

  NodeConfig config_;                                       // constant after construction
  GraphAnnouncement& graph_;                                // outlives this
  ros::MessageSink* watchers_;                              // outlives this; null without watchers
  std::optional<ros::MessageSink::TopicId> left_, second_;  // image topics of watchers
  Timestamp stamp_ = wall_time();                           // stamp of the last image; start time before the first
  OptionalOutput odometry_, pose_, tf_, tf_static_, diagnostics_, path_, points_, grid_, health_, events_;
  std::optional<OdometrySample> last_;  // previous frame; empty if the twist cannot be computed from it
  std::ostringstream event_lines_;
  EventLog event_log_{event_lines_};
  int frames_ = 0;
  bool has_published_points_ = false;  // whether the points of a constant map were published
};

}  // namespace byre
