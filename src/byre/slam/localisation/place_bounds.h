#pragma once

#include "byre/health.h"
#include "byre/slam/places/offline_map.h"
#include "byre/trajectory.h"

#include <optional>

namespace byre {

struct PlaceBoundsOptions {
  // The mission's cameras are those of the map, at the same height.
  bool is_on_ground_of_map = true;
  double plane_margin = 0.3;       // metres of height off the driven ground, beyond its uncertainty
  double plane_margin_tilt = 0.1;  // radians of tilt against that ground, beyond its uncertainty
  // Error of walls on the plan, metres, beyond the uncertainty of the registration.
  double wall_margin = 0.5;
};

struct PlaceCandidatePose {
  Timestamp time{};
  Pose map_from_body;
  Matrix6 covariance = Matrix6::Zero();  // see FrameReport
};

// Poses that are possible for the robot: on the ground that the map was driven on, and between the walls of the floor
// plan. Each bound is the 95 % quantile of all uncertainty plus a margin. Constant after construction.
class PlaceBounds {
 public:
  // The map must outlive it.
  PlaceBounds(const OfflineMap& map, const PlaceBoundsOptions& options)
      : ground_(options.is_on_ground_of_map ? map.ground() : nullptr), walls_(map.walls()), options_(options) {}

  // Motion since an earlier pose, at most max_speed metres per second.
  struct Reach {
    StampedPose before;  // beyond doubt
    double max_speed = 3.0;
  };
  // Reason why the robot cannot be at a place; DistrustReason::none if it can.
  DistrustReason rejection_reason(const PlaceCandidatePose& place, const std::optional<Reach>& reach) const;

 private:
  bool is_off_the_ground(const PlaceCandidatePose& place) const;
  PlanDisc disc_around(const Pose& map_from_body, const Matrix6& covariance) const;
  DistrustReason wall_rejection(const PlaceCandidatePose& place, const std::optional<Reach>& reach) const;

  const DrivenGround* ground_;  // nullptr: no constraint by the ground
  const PlacedWalls* walls_;    // nullptr: no walls given
  PlaceBoundsOptions options_;
};

// The last trusted pose in the offline map, and the rejected places reported since.
class TrustedPlace {
 public:
  explicit TrustedPlace(double max_speed) : max_speed_(max_speed) {}  // metres per second

  void note(const StampedPose& place) { place_ = place; }
  void forget() { place_.reset(); }  // the robot may have been carried, or the pose was wrong

  std::optional<PlaceBounds::Reach> reach_from_there() const;  // empty without a trusted pose

  // Whether to report a rejected place: once for each reason, until a pose is not untrusted.
  bool is_new_refusal(DistrustReason refused, Verdict verdict);

 private:
  double max_speed_;  // constant after construction
  std::optional<StampedPose> place_;
  DistrustReason reported_ = DistrustReason::none;
};

}  // namespace byre
