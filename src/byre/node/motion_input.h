#pragma once

#include "byre/dataset/stamp_clock.h"
#include "byre/dataset/wheel_stream.h"
#include "byre/dds/ros_graph.h"
#include "byre/node/node_config.h"
#include "byre/node/slam_runner.h"

#include <deque>
#include <optional>
#include <string>

namespace byre {

// What the topics of wheels and of a gyroscope bring. It is kept until the next frame, whose stamp tells whether the
// clock was set meanwhile.
class MotionInput {
 public:
  MotionInput(const NodeConfig& config, Participant& participant, GraphAnnouncement& graph);

  void take();
  // Precondition: the runner is running. clock: of the images.
  void tell(const StampClock& clock, SlamRunner& runner);
  // Fault of a topic, reported once; empty: nothing new.
  std::string news();
  // Topic of a sensor.
  std::string source_of(MotionSensor sensor) const;

 private:
  Subscriber subscribe(const std::string& topic, const MessageType& type);
  void look_for_wheels();

  // Constant after construction.
  NodeConfig config_;
  Participant& participant_;
  GraphAnnouncement& graph_;

  std::optional<Subscriber> wheels_;  // once somebody publishes their topic
  std::string wheels_type_;
  std::optional<Subscriber> gyroscope_;
  WheelStream stream_;
  bool are_rates_unmeasured_ = false;  // a message marked rates as not measured
  bool is_reported_ = false;
  std::deque<WheelSample> samples_;  // the last seconds of wheels, by their own stamps
  std::deque<ImuSample> imu_;        // the last seconds, by their own stamps
};

}  // namespace byre
