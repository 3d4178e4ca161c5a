#pragma once

#include "byre/frame_report.h"

#include <optional>

namespace byre {

// Frames of REP-105 from tracking reports: map -> odom -> base. odom never jumps, even if tracking is restarted.
// map -> odom is updated while the verdict is not `untrusted`, held otherwise, and withdrawn once the robot is lost, so
// that controllers in the map frame stop.
class PoseFrames {
 public:
  // Starts a new run: its odometry has a new frame, and its map may be another one.
  void restart();

  // Precondition: map_from_body of the report is in the published map frame.
  void note(const FrameReport& report);
  // As above, where another node owns odom -> base: its pose at the time of the image, empty if not known.
  void note(const FrameReport& report, const std::optional<Pose>& odom_from_base_of_owner);

  const std::optional<Pose>& odom_from_base() const { return odom_from_base_; }  // own odometry; empty while unknown
  bool is_odometry_own() const { return is_odometry_own_; }
  const std::optional<Pose>& map_from_odom() const { return map_from_odom_; }  // empty while unknown or withdrawn
  bool is_held() const { return is_held_; }                                    // whether map_from_odom is outdated

 private:
  void note_odometry(const FrameReport& report);
  void update(const FrameReport& report, const std::optional<Pose>& odom_from_base);

  std::optional<Pose> odom_from_start_ = Pose{};  // empty until the first pose of a run
  Pose last_odom_from_base_;
  std::optional<Pose> odom_from_base_;
  std::optional<Pose> map_from_odom_;
  bool is_odometry_own_ = true;
  bool is_held_ = false;
};

}  // namespace byre
