#pragma once

#include "byre/frame_report.h"

#include <optional>

namespace byre {

// The frames of REP-105 by what tracking reports: map -> odom -> base. odom never jumps, not even where tracking begins
// anew. map -> odom is known while the pose in the map may be relied on, held where it may not for a while, and
// withdrawn once it is not known where the robot is, so that whoever steers by the map stops.
class PoseFrames {
 public:
  // Poses that come next are of another run, whose odometry has a frame of its own, and of another map.
  void begin_anew();

  // The report's pose in the map: in the map frame that is published.
  void note(const FrameReport& report);

  const std::optional<Pose>& odom_from_base() const { return odom_from_base_; }  // empty while it is not known
  const std::optional<Pose>& map_from_odom() const { return map_from_odom_; }    // empty before and when withdrawn
  bool is_held() const { return is_held_; }                                      // whether map_from_odom is an old one

 private:
  std::optional<Pose> odom_from_start_ = Pose{};  // empty until the first pose of a run
  Pose last_odom_from_base_;
  std::optional<Pose> odom_from_base_;
  std::optional<Pose> map_from_odom_;
  bool is_held_ = false;
};

}  // namespace byre
