#pragma once

#include "byre/optimise/bundle_adjustment.h"

#include <map>
#include <random>
#include <utility>
#include <vector>

namespace byre {

// Bundle problem of a whole site. A forward-looking camera drives all lanes of a square site up and down, first the
// lanes along, then those across. At crossings it observes the points of the other lane. Co-observations thus connect
// the poses as a grid, and a cut through the site crosses all lanes.
class ConnectedSite {
 public:
  ConnectedSite(int poses, int points);

  const BundleProblem& problem() const { return problem_; }
  // Root mean square error, metres.
  double position_error(const std::vector<Pose>& camera_from_world) const;

 private:
  using Cell = std::pair<int, int>;

  Pose pose_after(double distance, double length) const;
  Vector6 random_motion(double metres, double radians);
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator_); }
  double normal(double sigma) { return std::normal_distribution<double>(0.0, sigma)(generator_); }
  bool observes(int pose, const Eigen::Vector3d& point_in_world) const;
  std::vector<int> observing_poses(const Eigen::Vector3d& point_in_world, int near, std::size_t most) const;
  void add_point();
  void add_observation(int pose);

  int lanes_;  // in each direction
  std::mt19937 generator_{1};
  BundleProblem problem_;
  std::map<Cell, std::vector<int>> cells_;  // poses by position
  std::vector<Pose> truth_;
};

}  // namespace byre
