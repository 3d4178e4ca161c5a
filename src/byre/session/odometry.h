#pragma once

#include "byre/pose.h"

namespace byre {

// The smooth pose beside the corrected one: whatever moves the map, or the pose in it, without the robot moving is
// taken out again. Its frame is that of the body at the start.
class Odometry {
 public:
  Pose pose(const Pose& map_from_body) const { return odometry_from_map_ * map_from_body; }
  double travelled() const { return travelled_; }  // metres

  void start(const Pose& map_from_body) { odometry_from_map_ = inverse(map_from_body); }
  // What was taken for one pose turned out to be the other.
  void absorb(const Pose& map_from_body_before, const Pose& map_from_body_after) {
    odometry_from_map_ = odometry_from_map_ * map_from_body_before * inverse(map_from_body_after);
  }
  void travel(double metres) { travelled_ += metres; }

 private:
  Pose odometry_from_map_;
  double travelled_ = 0.0;
};

}  // namespace byre
