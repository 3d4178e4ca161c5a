#pragma once

#include "byre/frame_report.h"

#include <optional>
#include <string>

namespace byre {

// Velocity of the robot in its own frame.
struct FleetVelocity {
  double vx = 0.0;     // m/s, ahead
  double vy = 0.0;     // m/s, to the left
  double omega = 0.0;  // rad/s, counterclockwise
};

// Position of a robot for fleet managers.
struct FleetPosition {
  double x = 0.0, y = 0.0;                // metres, in the frame of the map or of its floor plan
  double theta = 0.0;                     // yaw, radians from -pi to pi, counterclockwise from the x axis
  bool is_initialised = false;            // whether the position is valid
  double score = 0.0;                     // confidence from 0 to 1, see localization_score
  std::optional<double> deviation;        // metres, see position_error
  std::optional<FleetVelocity> velocity;  // empty without odometry
  std::string problem;                    // reason why the position is not trusted; empty if trusted
  std::string advice;                     // remedy for the problem; may be empty
};

// 0.5 to 1 for trusted poses, falling with the share of the permitted error; at most 0.4 if degraded, 0.1 if untrusted,
// and 0 without a pose.
double localization_score(const FrameReport& report);

// Position from the frames so far. Valid from the first trusted frame on, until the event navigation_error, or until
// frames cease.
class FleetPositionKeeper {
 public:
  // The report's pose is in the published frame. arrived: of a monotonic clock; advice: remedy for the frame's doubt.
  void note(const FrameReport& report, Timestamp arrived, const std::string& advice);

  // Starts over for another map or global relocalisation.
  void restart();

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
