#include "byre/slam/localisation/place_bounds.h"

#include "byre/geometry/decompositions.h"

#include <algorithm>
#include <cmath>

namespace byre {
namespace {

constexpr double kSigmasOfLine = 1.96;   // 95 % in one dimension
constexpr double kSigmasOfPlane = 2.45;  // 95 % in two dimensions

double largest_sigma(const Eigen::Matrix2d& covariance) {
  return std::sqrt(std::max(0.0, symmetric_eigenvalues(covariance)[1]));
}

}  // namespace

bool PlaceBounds::is_off_the_ground(const PlaceCandidatePose& place) const {
  const DrivenGround::GroundOffset offset = ground_->offset_from_ground(place.map_from_body);
  const Eigen::Vector3d& up = offset.up_in_body;
  const double height_variance = up.dot(place.covariance.topLeftCorner<3, 3>() * up);
  const double tilt_variance = rotation_variance(place.covariance);
  const double height_bound =
      options_.plane_margin + kSigmasOfLine * std::hypot(offset.height_sigma, std::sqrt(height_variance));
  const double tilt_bound =
      options_.plane_margin_tilt + kSigmasOfPlane * std::hypot(offset.tilt_sigma, std::sqrt(tilt_variance));
  return std::abs(offset.height) > height_bound || offset.tilt > tilt_bound;
}

PlanDisc PlaceBounds::disc_around(const Pose& map_from_body, const Matrix6& covariance) const {
  const Matrix6 on_plan = covariance_on_plan(walls_->registration, map_from_body, covariance);
  const Pose placed = plan_from_body(walls_->registration, map_from_body);
  const Eigen::Matrix3d turn = placed.rotation.toRotationMatrix();
  const Eigen::Matrix3d of_position = turn * on_plan.topLeftCorner<3, 3>() * turn.transpose();
  return {placed.translation.head<2>(),
          options_.wall_margin + kSigmasOfPlane * largest_sigma(of_position.topLeftCorner<2, 2>())};
}

// A path around a wall takes time. After kUntilItIsCarried without a pose help is called, and the robot may be carried.
DistrustReason PlaceBounds::wall_rejection(const PlaceCandidatePose& place, const std::optional<Reach>& reach) const {
  constexpr double kSlack = 1.0;            // metres, error of the length of the path
  constexpr double kUntilItIsCarried = 10;  // seconds
  const PlanWalls& walls = walls_->walls;
  const PlanDisc here = disc_around(place.map_from_body, place.covariance);
  if (!walls.has_free_cell(here)) return DistrustReason::in_wall;
  if (!walls.has_reachable_cell(here)) return DistrustReason::outside;
  if (!reach) return DistrustReason::none;
  const double seconds = to_seconds(place.time - reach->before.time);
  if (seconds >= kUntilItIsCarried) return DistrustReason::none;
  const PlanDisc before = disc_around(reach->before.world_from_body, Matrix6::Zero());
  // The straight distance is always allowed: a place beyond the reach of max_speed needs more frames to be confirmed,
  // but is no evidence of a wall.
  const double longest = kSlack + std::max(reach->max_speed * seconds, (here.centre - before.centre).norm());
  return walls.path_length_between(before, here, longest) ? DistrustReason::none : DistrustReason::behind_wall;
}

DistrustReason PlaceBounds::rejection_reason(const PlaceCandidatePose& place, const std::optional<Reach>& reach) const {
  if (ground_ != nullptr && is_off_the_ground(place)) return DistrustReason::off_the_plane;
  return walls_ != nullptr ? wall_rejection(place, reach) : DistrustReason::none;
}

std::optional<PlaceBounds::Reach> TrustedPlace::reach_from_there() const {
  if (!place_) return std::nullopt;
  return PlaceBounds::Reach{*place_, max_speed_};
}

bool TrustedPlace::is_new_refusal(DistrustReason refused, Verdict verdict) {
  if (verdict != Verdict::untrusted) reported_ = DistrustReason::none;
  if (refused == DistrustReason::none || refused == reported_) return false;
  reported_ = refused;
  return true;
}

}  // namespace byre
