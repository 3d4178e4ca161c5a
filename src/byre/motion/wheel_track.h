#pragma once

#include "byre/body_motion.h"
#include "byre/trajectory.h"

#include <optional>
#include <vector>

namespace byre {

// What wheels tell: poses of the robot's base in a frame of their own, which drifts, or how fast the base moves.
class WheelTrack {
 public:
  // Samples that are not later than the one before are left out.
  void add(const StampedPose& sample);
  // Adds the first pose of a new segment of odometry. There is no motion between segments.
  void begin_segment(const StampedPose& first);
  // The base moves on by the mean of two velocities, along an arc. Nobody knows how fast it was while none came for
  // three tenths of a second: no motion is told across such a gap.
  void add(const BaseVelocity& sample);

  // Samples before a time may go, and do once they are two minutes older.
  void forget_before(Timestamp time);

  bool empty() const { return samples_.empty(); }
  // The base at a time between two samples at most half a second apart, or up to a quarter of a second after the last
  // one, by which the last motion is taken to go on.
  std::optional<Pose> pose_at(Timestamp time) const;
  // Motion of the base, earlier_from_later; empty if either end is unknown, or both are in different segments.
  std::optional<Pose> between(Timestamp earlier, Timestamp later) const;
  // Whether a segment ends between both times and the next one begins within a tenth of a second.
  bool has_jump(Timestamp earlier, Timestamp later) const;

  // How far the base went, and turned, to and fro counted; empty unless it was told all along.
  struct Distance {
    double metres = 0.0;
    double radians = 0.0;
  };
  std::optional<Distance> distance(Timestamp earlier, Timestamp later) const;

 private:
  bool is_broken(Timestamp earlier, Timestamp later) const;

  Trajectory samples_;
  std::optional<BaseVelocity> velocity_;  // the last sample's, where it was one
  std::vector<Timestamp> breaks_;         // times of samples that no motion leads to from the one before
};

}  // namespace byre
