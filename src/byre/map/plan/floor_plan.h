#pragma once

#include "byre/map/plan/driving_plane.h"
#include "byre/map/plan_registration.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// A point of the map that was picked on the floor plan.
struct PlanCorrespondence {
  std::string name;
  Eigen::Vector3d point_in_map = Eigen::Vector3d::Zero();
  Eigen::Vector2d point_in_plan = Eigen::Vector2d::Zero();  // metres
  double sigma = 0.05;  // metres, of x and of y, in the map and on the plan together
};

struct PlanRegistrationOptions {
  double body_height = 0.0;         // metres, of the body's origin above the floor
  double body_height_sigma = 0.05;  // metres
};

struct PlanResidual {
  Eigen::Vector2d error_in_plan = Eigen::Vector2d::Zero();  // by the map less as picked, metres
  bool is_outlier = false;                                  // excluded from the fit
};

// Reasons to doubt a registration.
enum class PlanDoubt : std::uint8_t {
  few_points,   // fewer than three correspondences used, so that none checks another
  in_line,      // the correspondences lie nearly on a line
  in_a_corner,  // the correspondences are close together and the map extends far beyond
  // The residuals exceed their sigmas, or a large share of the correspondences are outliers.
  disagreement,
  uneven_path,  // the path is not planar, so that the up direction comes mostly from the camera's attitude
};
std::string_view to_string(PlanDoubt doubt);  // a sentence with the remedy

struct PlanFit {
  PlanRegistration registration;        // plan name not set
  std::vector<PlanResidual> residuals;  // one per correspondence
  double rms = 0.0;                     // metres, root mean square of the residuals' lengths without outliers
  std::vector<PlanDoubt> doubts;
};

// Root-mean-square error of the map on its plan over the inliers, metres. Over all correspondences if the outliers are
// so many that they may be correct.
double residual_of(const PlanFit& fit);

// Limit of residual_of(), metres, above which a registration is stored only on the user's explicit request.
inline constexpr double kLargePlanResidual = 0.5;
bool has_large_residual(const PlanFit& fit);

// Registers a map on a plan: position and heading from correspondences seen from above, height and tilt from the
// driving plane, and the scale if it is free. Outliers are removed by find_planar_consensus. The inliers are fitted by
// weighted least squares, with the plane weighted by its own uncertainty. The covariance is scaled by the residuals.
// Empty with fewer than two separate correspondences.
std::optional<PlanFit> register_on_plan(std::span<const PlanCorrespondence> correspondences, const DrivingPlane& plane,
                                        Scale scale, const PlanRegistrationOptions& options = {});

}  // namespace byre
