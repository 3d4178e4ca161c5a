#pragma once

#include "byre/calibration.h"
#include "byre/trajectory.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace byre {

// Stereo camera of a feeding robot: 752 x 480 pixels divided by a whole number, 79 degrees horizontal field of view,
// radial-tangential lenses, baseline 0.15 m. Body frame: x forward, y left, z up, origin on the floor between the
// wheels; the cameras look forward from 0.9 m above it.
Calibration feeding_robot_calibration(int divisor);

//   arc   left half circle into the parallel lane
//   spot  left turn on the spot, back along the same lane
enum class TurnKind : std::uint8_t { arc, spot };

// Course of a feeding robot: along one side of the feed alley, a half turn, back along the other side, a half turn.
// World frame: x along the alley, y to its left, z up.
struct FeedingCourseOptions {
  TurnKind turn = TurnKind::arc;
  double far_x = 26.5;          // metres: largest x at which the outbound straight may end
  double latest_near_x = 22.0;  // metres: largest x at which it may begin; shorter laps end before far_x
  double lane_distance = 2.0;   // metres between outbound and return straight, of arcs
  double max_straight = 18.0;   // longest straight, metres; longer missions drive several laps
  double cruise_speed = 0.75;   // metres per second
  double turn_speed = 0.5;      // metres per second
  double duration_s = 40.0;     // one lap plus a metre, or several
  double shift_y = 0.0;         // offset of the whole course to the left, metres
  double start = 0.0;           // start position on the lap, 0 to 1
  std::uint64_t seed = 1;       // draws the vibration
};

class FeedingCourse {
 public:
  explicit FeedingCourse(const FeedingCourseOptions& options);

  // Metres; a turn on the spot counts by the distance a wheel rolls.
  double lap_length() const { return 2.0 * (straight_ + turn_length_); }
  double straight() const { return straight_; }  // metres

  // Body pose at time_s seconds from the start, with the vibration of wheels on concrete. The robot is at rest before
  // the start and after the end.
  Pose world_from_body(double time_s) const;

 private:
  struct PathPoint {
    Eigen::Vector2d position;
    double heading = 0.0;  // radians to the left of the world's x axis
  };
  double far_x() const { return std::min(options_.far_x, options_.latest_near_x + straight_); }            // metres
  double lane_distance() const { return options_.turn == TurnKind::spot ? 0.0 : options_.lane_distance; }  // metres
  PathPoint turn_point(double along_turn) const;
  PathPoint path_point(double along_lap) const;
  double target_speed(double along_half_lap, double straight) const;
  std::vector<double> drive(double straight) const;
  double travelled(double time_s) const;

  FeedingCourseOptions options_;
  double straight_ = 0.0;              // metres
  double turn_length_ = 0.0;           // metres
  std::vector<Eigen::Vector2d> turn_;  // along a turn that begins at the origin along x, in equal steps
  std::vector<double> travelled_;      // metres since the start, in equal time steps
};

}  // namespace byre
