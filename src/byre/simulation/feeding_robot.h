#pragma once

#include "byre/calibration.h"
#include "byre/trajectory.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace byre {

// A feeding robot's stereo camera: 752 x 480 pixels divided by a whole number, 79 degrees wide, radial-tangential
// lenses, baseline 0.15 m. The robot's body has x forward, y left and z up, and its origin on the floor between the
// wheels; the cameras look forward from 0.9 m above it.
Calibration feeding_robot_calibration(int divisor);

//   arc   to the left, into the lane beside
//   spot  to the left on the spot, back along the same lane
enum class TurnKind : std::uint8_t { arc, spot };

// The course of a feeding robot: along one side of the feed alley, a half turn, back along the other side, and a half
// turn again. World frame: x along the alley, y to its left, z up.
struct FeedingCourseOptions {
  TurnKind turn = TurnKind::arc;
  double far_x = 26.5;          // metres: where the way there ends and its turn begins, at the most
  double latest_near_x = 22.0;  // metres: where it begins at the latest: shorter laps do not reach far_x
  double lane_distance = 2.0;   // metres between the way there and the way back, of arcs
  double max_straight = 18.0;   // metres: longer missions drive several laps
  double cruise_speed = 0.75;   // metres per second
  double turn_speed = 0.5;      // metres per second
  double duration_s = 40.0;     // one lap and a metre more, or several
  double shift_y = 0.0;         // metres by which all of it lies to the left
  double start = 0.0;           // place on the lap to begin at, 0 to 1
  std::uint64_t seed = 1;       // draws the vibration
};

// Where the robot is at any time.
class FeedingCourse {
 public:
  explicit FeedingCourse(const FeedingCourseOptions& options);

  // Metres, where a turn on the spot counts as the way of a wheel.
  double lap_length() const { return 2.0 * (straight_ + turn_length_); }
  double straight() const { return straight_; }  // metres

  // The body at so many seconds from the start, with the vibration of wheels on concrete. Before the start and after
  // the end the robot stands.
  Pose world_from_body(double time_s) const;

  double speed(double time_s) const;  // metres per second, on the spot those of a wheel

 private:
  struct PathPoint {
    Eigen::Vector2d position;
    double heading = 0.0;  // radians to the left of the world's x axis
  };
  double far_x() const { return std::min(options_.far_x, options_.latest_near_x + straight_); }            // metres
  double lane_distance() const { return options_.turn == TurnKind::spot ? 0.0 : options_.lane_distance; }  // metres
  PathPoint turn_point(double along_turn) const;
  PathPoint path_point(double along_lap) const;
  double wanted_speed(double along_half_lap, double straight) const;
  std::vector<double> drive(double straight) const;
  double travelled(double time_s) const;

  FeedingCourseOptions options_;
  double straight_ = 0.0;              // metres
  double turn_length_ = 0.0;           // metres
  std::vector<Eigen::Vector2d> turn_;  // along a turn that begins at the origin along x, in even steps
  std::vector<double> travelled_;      // metres since the start, in even steps of time
};

}  // namespace byre
