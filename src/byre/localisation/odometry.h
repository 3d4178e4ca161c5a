#pragma once

#include "byre/pose.h"

#include <optional>

namespace byre {

// The pose of the body in the map, and the smooth pose (odometry), which corrections of the map do not move. The frame
// of the smooth pose is that of the body at the start. Poses that are not finite are ignored.
class Odometry {
 public:
  const Pose& map_from_body() const { return map_from_body_; }  // last pose, as it was then
  Pose odometry_from_body() const { return odometry_from_map_ * map_from_body_; }
  double travelled() const { return travelled_; }  // metres

  // The body did not move: what was taken for one pose turned out to be the other. The first pose comes so too.
  void correct(const Pose& map_from_body);

  // From where online points alone have the body to where it was tracked.
  struct Offset {
    Pose online_from_body;
    double sigma = 0.0;  // metres, of the position that online points give
  };

  // The way from the last frame to this one.
  struct Step {
    Pose smooth;          // map_from_body, had the map not moved the pose
    double metres = 0.0;  // to there
  };
  // The body was tracked to a pose. What offline points do to a pose that online points hold as well is no motion:
  // where the offset changes at once, by more than its uncertainty explains, the body is where it would be had it not.
  Step follow(const Pose& map_from_body, const std::optional<Offset>& offset);

  // The body is at a pose in the map that it was not tracked to, and has moved since the last frame as it was told.
  void go_by(const Pose& last_from_body, const Pose& map_from_body);

  // Sets the offset that the next pose is compared with; empty where the two have nothing to do with each other.
  void remember_offset(const std::optional<Offset>& offset) { offset_ = offset; }

 private:
  Pose without_change_of(const std::optional<Offset>& offset, const Pose& map_from_body) const;

  Pose map_from_body_;
  Pose odometry_from_map_;
  double travelled_ = 0.0;
  std::optional<Offset> offset_;  // offset of the last pose
};

}  // namespace byre
