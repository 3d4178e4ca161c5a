#pragma once

#include "byre/map/driving_plane.h"
#include "byre/map/path_cells.h"

#include <optional>
#include <vector>

namespace byre {

// The ground that a map was driven on: around each place of its path a plane of its own, so that ramps and floors above
// each other are no exception. Lengths in the map's unit.
class DrivenGround {
 public:
  // Empty where the map was not driven: where heights and tilts along its path spread as they do when a camera is
  // carried or flown, where the path is too short to tell, or which way is up is not known.
  static std::optional<DrivenGround> under(const Map& map);

  // How a body stands on the ground nearest to it.
  struct Stand {
    double height = 0.0;                                    // height of its origin above those of the path's bodies
    double height_sigma = 0.0;                              // what the path leaves open there
    Eigen::Vector3d up_in_body = Eigen::Vector3d::UnitZ();  // normal of the ground, unit length
    Eigen::Vector3d up_in_map = Eigen::Vector3d::UnitZ();   // normal of the ground, unit length
    double tilt = 0.0;                                      // radians, against how the path's bodies stand
    double tilt_sigma = 0.0;                                // radians, in each of two directions
    double distance = 0.0;                                  // to the nearest place of the path
  };
  Stand stand_of(const Pose& map_from_body) const;

  // How bodies of the path stand: the direction that is up when the ground is level, as the body has it.
  const Eigen::Vector3d& up_in_body() const { return up_in_body_; }
  double height_spread() const { return height_spread_; }  // root mean square of heights above the ground around
  double tilt_spread() const { return tilt_spread_; }      // radians, root mean square of tilts in one direction

 private:
  explicit DrivenGround(std::vector<Pose> path);

  const Pose& nearest_to(const Eigen::Vector3d& position_in_map) const;
  DrivingPlane plane_around(const Eigen::Vector3d& position_in_map) const;

  std::vector<Pose> path_;  // map_from_body
  PathCells cells_;         // the path's places
  Eigen::Vector3d up_in_body_ = Eigen::Vector3d::UnitZ();
  double height_spread_ = 0.0;
  double tilt_spread_ = 0.0;
};

}  // namespace byre
