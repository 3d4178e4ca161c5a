#pragma once

#include "byre/dds/ros_graph.h"
#include "byre/node/node_config.h"
#include "byre/node/slam_runner.h"
#include "byre/node/stamp_clock.h"

#include <deque>
#include <optional>

namespace byre {

// What the topics of wheels and of a gyroscope bring. It is kept until the next frame, whose stamp tells whether the
// clock was set meanwhile.
class MotionInput {
 public:
  MotionInput(const NodeConfig& config, Participant& participant, GraphAnnouncement& graph);

  void take();
  // Precondition: the runner is running. clock: of the images.
  void tell(const StampClock& clock, SlamRunner& runner);

 private:
  NodeConfig config_;  // constant after construction
  std::optional<Subscriber> wheels_;
  std::optional<Subscriber> gyroscope_;
  std::deque<StampedPose> poses_;  // the last seconds, by their own stamps
  std::deque<AngularRate> rates_;  // the last seconds, by their own stamps
};

}  // namespace byre
