#pragma once

#include "byre/map/plan/driving_plane.h"
#include "byre/map/plan/path_cells.h"

#include <optional>
#include <vector>

namespace byre {

// The ground that a map was driven on: a local plane at each position of its path, which covers ramps and several
// floors. Lengths in the map's unit.
class DrivenGround {
 public:
  // base: up axis of the robot's base, normal to the ground; a path that turns refines it. Without a base the axis
  // comes from the path. Empty if the map was not driven: heights and tilts along its path vary as with a hand-held or
  // flying camera; without a base also if the path is short, or the up direction unknown.
  static std::optional<DrivenGround> under(const MapGraph& map, const std::optional<UpInBody>& base = {});

  // A body relative to the ground nearest to it.
  struct GroundOffset {
    double height = 0.0;                                    // height of its origin above those of the path's bodies
    double height_sigma = 0.0;                              // standard deviation of the ground's height there
    Eigen::Vector3d up_in_body = Eigen::Vector3d::UnitZ();  // normal of the ground, unit length
    Eigen::Vector3d up_in_map = Eigen::Vector3d::UnitZ();   // normal of the ground, unit length
    double tilt = 0.0;                                      // radians, from the attitude of the path's bodies
    double tilt_sigma = 0.0;                                // radians, per axis
    double distance = 0.0;                                  // to the nearest position of the path
  };
  GroundOffset offset_from_ground(const Pose& map_from_body) const;

  // Attitude of the path's bodies: the up direction on level ground, in the body frame.
  const Eigen::Vector3d& up_in_body() const { return up_in_body_; }
  double tilt_spread() const { return tilt_spread_; }  // radians, root mean square of tilts per axis

 private:
  explicit DrivenGround(std::vector<Pose> path);

  const Pose& nearest_to(const Eigen::Vector3d& position_in_map) const;
  DrivingPlane plane_around(const Eigen::Vector3d& position_in_map) const;

  std::vector<Pose> path_;  // map_from_body
  PathCells cells_;         // positions of the path
  Eigen::Vector3d up_in_body_ = Eigen::Vector3d::UnitZ();
  double up_sigma_ = kUprightSigma;  // radians
  double height_spread_ = 0.0;
  double tilt_spread_ = 0.0;
};

}  // namespace byre
