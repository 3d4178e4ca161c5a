#include "byre/localisation/place_bounds.h"

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

bool PlaceBounds::is_off_the_ground(const PlaceToJudge& place) const {
  const DrivenGround::Stand stand = ground_->stand_of(place.map_from_body);
  const Eigen::Vector3d& up = stand.up_in_body;
  const double height_variance = up.dot(place.covariance.topLeftCorner<3, 3>() * up);
  const double tilt_variance = place.covariance.bottomRightCorner<3, 3>().trace();
  const double height_bound =
      options_.plane_margin + kSigmasOfLine * std::hypot(stand.height_sigma, std::sqrt(height_variance));
  const double tilt_bound =
      options_.plane_margin_tilt + kSigmasOfPlane * std::hypot(stand.tilt_sigma, std::sqrt(tilt_variance));
  return std::abs(stand.height) > height_bound || stand.tilt > tilt_bound;
}

PlanDisc PlaceBounds::disc_around(const Pose& map_from_body, const Matrix6& covariance) const {
  const Matrix6 on_plan = covariance_on_plan(walls_->registration, map_from_body, covariance);
  const Pose placed = plan_from_body(walls_->registration, map_from_body);
  const Eigen::Matrix3d turn = placed.rotation.toRotationMatrix();
  const Eigen::Matrix3d of_position = turn * on_plan.topLeftCorner<3, 3>() * turn.transpose();
  return {placed.translation.head<2>(),
          options_.wall_margin + kSigmasOfPlane * largest_sigma(of_position.topLeftCorner<2, 2>())};
}

// A way around a wall takes time. After kUntilItIsCarried without a pose help is called, and the robot may be carried.
Doubt PlaceBounds::wall_against(const PlaceToJudge& place, const std::optional<Way>& way) const {
  constexpr double kSlack = 1.0;            // metres, error of the length of the way
  constexpr double kUntilItIsCarried = 10;  // seconds
  const PlanWalls& walls = walls_->walls;
  const PlanDisc here = disc_around(place.map_from_body, place.covariance);
  if (!walls.has_free_place(here)) return Doubt::in_wall;
  if (!walls.has_place_to_drive_to(here)) return Doubt::outside;
  if (!way) return Doubt::none;
  const double seconds = to_seconds(place.time - way->before.time);
  if (seconds >= kUntilItIsCarried) return Doubt::none;
  const PlanDisc before = disc_around(way->before.map_from_body, Matrix6::Zero());
  // The straight distance is always allowed: a place beyond the reach of max_speed needs more frames to be believed,
  // but is no evidence of a wall.
  const double longest = kSlack + std::max(way->max_speed * seconds, (here.centre - before.centre).norm());
  return walls.way_between(before, here, longest) ? Doubt::none : Doubt::behind_wall;
}

Doubt PlaceBounds::reason_against(const PlaceToJudge& place, const std::optional<Way>& way) const {
  if (ground_ != nullptr && is_off_the_ground(place)) return Doubt::off_the_plane;
  return walls_ != nullptr ? wall_against(place, way) : Doubt::none;
}

}  // namespace byre
