#pragma once

#include "byre/health.h"
#include "byre/slam/offline_map.h"
#include "byre/trajectory.h"

#include <optional>

namespace byre {

struct PlaceBoundsOptions {
  // The mission's cameras are those of the map, so that they sit as high; others may sit anywhere.
  bool is_on_ground_of_map = true;
  double plane_margin = 0.3;       // metres of height off the ground that was driven on, beyond its uncertainty
  double plane_margin_tilt = 0.1;  // radians of tilt against that ground, beyond its uncertainty
  double wall_margin = 0.5;  // metres by which a wall may lie beside the plan, beyond the registration's uncertainty
};

// A place where a frame was found.
struct PlaceToJudge {
  Timestamp time{};
  Pose map_from_body;
  Matrix6 covariance = Matrix6::Zero();  // see FrameReport
};

// A place where the robot was, beyond doubt, before.
struct PlaceBefore {
  Timestamp time{};
  Pose map_from_body;
};

// Where the robot can be: on the ground that the map was driven on, and between the walls of the floor plan.
// Each bound is wide enough for all that is uncertain: 95 of 100 places right at its edge, and a margin beside.
// Constant after construction.
class PlaceBounds {
 public:
  // The map outlives it.
  PlaceBounds(const OfflineMap& map, const PlaceBoundsOptions& options)
      : ground_(options.is_on_ground_of_map ? map.ground() : nullptr), walls_(map.walls()), options_(options) {}

  // The way since then: how fast the robot may go, metres per second.
  struct Way {
    PlaceBefore before;
    double max_speed = 3.0;
  };
  // Why the robot cannot be there; Doubt::none where it can.
  Doubt reason_against(const PlaceToJudge& place, const std::optional<Way>& way) const;

 private:
  bool is_off_the_ground(const PlaceToJudge& place) const;
  PlanDisc disc_around(const Pose& map_from_body, const Matrix6& covariance) const;
  Doubt wall_against(const PlaceToJudge& place, const std::optional<Way>& way) const;

  const DrivenGround* ground_;  // nullptr where the ground tells nothing
  const PlacedWalls* walls_;    // nullptr where no walls are known
  PlaceBoundsOptions options_;
};

}  // namespace byre
