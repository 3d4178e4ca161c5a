#pragma once

#include "byre/map/driving_plane.h"
#include "byre/map/plan_registration.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// A point of the map that somebody has found on the floor plan.
struct PlanCorrespondence {
  std::string name;
  Eigen::Vector3d point_in_map = Eigen::Vector3d::Zero();
  Eigen::Vector2d point_in_plan = Eigen::Vector2d::Zero();  // metres
  double sigma = 0.05;  // metres, of x and of y: how well the point is known in the map and on the plan together
};

struct PlanRegistrationOptions {
  double body_height = 0.0;         // metres, of the body's origin above the floor
  double body_height_sigma = 0.05;  // metres
};

// How a correspondence fits.
struct PlanResidual {
  Eigen::Vector2d error_in_plan = Eigen::Vector2d::Zero();  // place by the map less the place that was picked, metres
  bool is_outlier = false;                                  // whether it took no part
};

// What makes a registration doubtful though it was found.
enum class PlanDoubt : std::uint8_t {
  few_points,   // fewer than three correspondences took part, so that none checks another
  in_line,      // the correspondences lie nearly on a line
  in_a_corner,  // the correspondences lie close together and the map reaches far beyond
  // The correspondences are farther off than their sigmas explain, or a large part of them is wrong.
  disagreement,
  uneven_path,  // the path lies in no plane, so which way is up comes mostly from how the camera was held
};
std::string_view to_string(PlanDoubt doubt);  // a sentence with its remedy

struct PlanFit {
  PlanRegistration registration;        // registration on a plan that has no name yet
  std::vector<PlanResidual> residuals;  // one for each correspondence
  double rms = 0.0;                     // metres, of the errors' lengths without outliers
  std::vector<PlanDoubt> doubts;
};

// How far a map is off its plan, in metres: the root mean square of the errors of the picks that took part. Where so
// many were left out that they may be the right ones, it is that of all.
double residual_of(const PlanFit& fit);

// Off by more than this, in metres, a map is not to be kept on its plan unless somebody who was told the figure wants
// it.
inline constexpr double kFarOffPlan = 0.5;
bool is_far_off(const PlanFit& fit);

// Finds where a map lies on a plan from correspondences seen from above, its height and tilt from the plane driven on,
// and its scale too when that is free. Correspondences that do not agree with the others are told apart, see
// find_planar_consensus; the others are fitted by weighted least squares, in which the plane takes part with its own
// uncertainty. The covariance follows from the residuals' size. Empty for fewer than two correspondences that lie
// apart.
std::optional<PlanFit> register_on_plan(std::span<const PlanCorrespondence> correspondences, const DrivingPlane& plane,
                                        Scale scale, const PlanRegistrationOptions& options = {});

}  // namespace byre
