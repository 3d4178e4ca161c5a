#pragma once

#include "byre/pose.h"

#include <optional>

namespace byre {

// The body's pose in the map, and the smooth pose (odometry), which map corrections do not move. The frame of the
// smooth pose is the body's at the start. Non-finite poses are ignored.
class Odometry {
 public:
  const Pose& map_from_body() const { return map_from_body_; }  // last pose, with its corrections
  Pose odometry_from_body() const { return odometry_from_map_ * map_from_body_; }
  double travelled() const { return travelled_; }  // metres

  // Map correction: the map pose jumps, odometry does not. Also sets the first pose.
  void correct(const Pose& map_from_body);

  // Tracked body pose relative to the body pose from online points alone.
  struct Offset {
    Pose online_from_body;
    double sigma = 0.0;  // metres, of the position from online points
  };

  // Motion since the last frame.
  struct Step {
    Pose smooth;          // map_from_body without a jump by offline points
    double metres = 0.0;  // length of the motion
  };
  // The body was tracked to a pose. A sudden change of the offset, beyond its uncertainty, is a jump by offline points
  // and no motion: odometry does not advance_to it.
  Step advance_to(const Pose& map_from_body, const std::optional<Offset>& offset);

  // Sets a map pose that was not tracked from the last one, and moves the odometry by the measured motion since the
  // last frame.
  void move_by_odometry(const Pose& last_from_body, const Pose& map_from_body);

  // Sets the offset that the next pose is compared with; empty: not comparable.
  void set_offset(const std::optional<Offset>& offset) { offset_ = offset; }

 private:
  Pose without_change_of(const std::optional<Offset>& offset, const Pose& map_from_body) const;

  Pose map_from_body_;
  Pose odometry_from_map_;
  double travelled_ = 0.0;
  std::optional<Offset> offset_;  // offset of the last pose
};

}  // namespace byre
