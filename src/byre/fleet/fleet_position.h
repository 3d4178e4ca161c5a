#pragma once

#include "byre/frame_report.h"

#include <optional>
#include <string>

namespace byre {

// Motion of the robot as seen in itself.
struct FleetVelocity {
  double vx = 0.0;     // m/s, ahead
  double vy = 0.0;     // m/s, to the left
  double omega = 0.0;  // rad/s, counterclockwise
};

// Where a robot is, as fleets ask for it.
struct FleetPosition {
  double x = 0.0, y = 0.0;                // metres, in the frame of the map or of its floor plan
  double theta = 0.0;                     // radians from -pi to pi, counterclockwise from the x axis
  bool is_initialised = false;            // whether it is known where the robot is
  double score = 0.0;                     // 0 unknown to 1 known, see localization_score
  std::optional<double> deviation;        // metres, see position_error
  std::optional<FleetVelocity> velocity;  // empty without a smooth pose
  std::string problem;                    // why the position is not trusted; empty where it is
  std::string advice;                     // what to do about that; empty where there is nothing to do
};

// 0.5 to 1 while the pose is trusted, by how much of the error that trust allows is taken up; at most 0.4 while it is
// degraded, 0.1 while it is untrusted, and 0 without a pose.
double localization_score(const FrameReport& report);

// The position as it is known from the frames so far. It counts as initialised from a trusted frame on until it is not
// known where the robot is (event navigation_error), or no frames come.
class FleetPositionKeeper {
 public:
  // The report's pose is in the frame that is published. arrived: a time that never goes back; advice: what to do about
  // the frame's doubt.
  void note(const FrameReport& report, Timestamp arrived, const std::string& advice);

  // What comes next is in another map, or is looked for anew.
  void begin_anew();

  FleetPosition at(Timestamp now) const;

 private:
  struct Odometry {
    Timestamp time{};
    Pose odometry_from_body;
  };

  FleetPosition position_;
  std::optional<Odometry> odometry_;
  std::optional<Timestamp> arrived_;
};

}  // namespace byre
