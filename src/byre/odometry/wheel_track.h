#pragma once

#include "byre/body_motion.h"
#include "byre/trajectory.h"

#include <optional>
#include <vector>

namespace byre {

// Wheel odometry: base poses in a drifting odometry frame, or base velocities.
class WheelTrack {
 public:
  // Samples that are not later than the previous one are dropped.
  void add(const StampedPose& sample);
  // Adds the first pose of a new segment of odometry. There is no motion between segments.
  void begin_segment(const StampedPose& first);
  // Integrates the mean of two consecutive velocities along an arc. Velocities more than 0.3 s apart have no motion
  // between them.
  void add(const BaseTwist& sample);

  // Samples before a time are no longer needed. They are erased once they are two minutes older.
  void forget_before(Timestamp time);

  bool empty() const { return samples_.empty(); }
  // Pose of the base. Interpolated between two samples at most 0.5 s apart; extrapolated with the last motion up to
  // 0.25 s after the last sample, and with the first motion up to 0.05 s before the first one.
  std::optional<Pose> pose_at(Timestamp time) const;
  // Motion of the base, earlier_from_later; empty if either end is unknown, or both are in different segments.
  std::optional<Pose> between(Timestamp earlier, Timestamp later) const;
  // Whether a segment ends between both times and the next one begins within a tenth of a second.
  bool has_jump(Timestamp earlier, Timestamp later) const;

  // Length of the path and sum of the absolute turns; empty if the samples have a gap.
  struct Distance {
    double metres = 0.0;
    double radians = 0.0;
  };
  std::optional<Distance> distance(Timestamp earlier, Timestamp later) const;

 private:
  bool is_broken(Timestamp earlier, Timestamp later) const;
  std::optional<Pose> pose_before_first(Timestamp time) const;

  Trajectory samples_;
  std::optional<BaseTwist> velocity_;  // velocity of the last sample, if it has one
  std::vector<Timestamp> breaks_;      // times of samples without a motion from the previous one
};

}  // namespace byre
