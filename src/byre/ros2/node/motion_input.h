#pragma once

#include "byre/io/recording/motion_files.h"
#include "byre/io/recording/stamp_clock.h"
#include "byre/ros2/dds/ros_graph.h"
#include "byre/ros2/node/input_monitor.h"
#include "byre/ros2/node/node_config.h"
#include "byre/ros2/node/slam_runner.h"

#include <deque>
#include <optional>
#include <string>

namespace byre {

// Samples from the topics of wheels and gyroscope. Held until the next frame, whose stamp reveals whether the clock was
// set.
class MotionInput {
 public:
  // Its topics are added to the monitor. The graph and the monitor outlive this.
  MotionInput(const NodeConfig& config, GraphAnnouncement& graph, InputMonitor& monitor);
  MotionInput(const MotionInput&) = delete;  // the monitor refers to it
  MotionInput& operator=(const MotionInput&) = delete;

  void take();
  // Passes samples on. clock: of the images. Precondition: the runner is running.
  void forward(const StampClock& clock, SlamRunner& runner);
  // New fault of a topic, reported once; empty without one.
  std::string take_fault();
  // Frame whose motion the wheels measure, by their first message; empty before it.
  const std::optional<std::string>& base_of_wheels() const { return base_of_wheels_; }
  // Topic of a sensor, for messages.
  std::string source_of(MotionSensor sensor) const;

 private:
  Subscriber subscribe(const std::string& topic, const MessageType& type);
  void find_wheels();

  // Constant after construction.
  NodeConfig config_;
  GraphAnnouncement& graph_;
  InputMonitor& monitor_;
  std::optional<InputMonitor::Id> wheels_input_, gyroscope_input_;  // empty if not configured

  std::optional<Subscriber> wheels_;  // empty until the topic has a publisher
  std::string wheels_type_;
  std::optional<std::string> base_of_wheels_;
  std::optional<Subscriber> gyroscope_;
  WheelStream stream_;
  bool has_unmeasured_rates_ = false;  // whether a message marked rates as not measured
  bool is_reported_ = false;
  std::deque<WheelSample> samples_;  // wheel samples of the last seconds, by their own stamps
  std::deque<ImuSample> imu_;        // samples of the last seconds, by their own stamps
};

}  // namespace byre
