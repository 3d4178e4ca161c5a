#pragma once

#include "byre/trajectory.h"

#include <optional>

namespace byre {

// What wheels tell: poses of the robot's base in a frame of their own, which drifts.
class WheelTrack {
 public:
  // Samples that are not later than the one before are left out.
  void add(const StampedPose& sample);

  // Samples before a time may go, and do once they are two minutes older.
  void forget_before(Timestamp time);

  bool empty() const { return samples_.empty(); }
  // The base at a time between two samples at most half a second apart, or up to a quarter of a second after the last
  // one, by which the last motion is taken to go on.
  std::optional<Pose> pose_at(Timestamp time) const;
  // The base's motion, earlier_from_later; empty where either end is not known.
  std::optional<Pose> between(Timestamp earlier, Timestamp later) const;

  // How far the base went, and turned, to and fro counted; empty unless it was told all along.
  struct Distance {
    double metres = 0.0;
    double radians = 0.0;
  };
  std::optional<Distance> distance(Timestamp earlier, Timestamp later) const;

 private:
  Trajectory samples_;
};

}  // namespace byre
