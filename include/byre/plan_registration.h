#pragma once

#include "byre/alignment.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace byre {

using Matrix7 = Eigen::Matrix<double, 7, 7>;

// Registration of a map on a floor plan. Plan frame: x and y as on the plan, z up from the driven floor; metres.
struct PlanRegistration {
  std::string plan;          // name of the plan
  Similarity plan_from_map;  // scale: metres per unit of the map, 1 for a metric one
  // Covariance of delta in plan_from_map * exp_pose(delta), translation (metres) and rotation vector (radians) in the
  // map frame, and of the logarithm of the scale; zero for a fixed scale.
  Matrix7 covariance = Matrix7::Zero();
};

// The pose on the plan: lengths become metres, and the rest is a rigid motion.
Pose plan_from_body(const PlanRegistration& registration, const Pose& map_from_body);

// Covariance of delta in plan_from_body * exp_pose(delta), metres and radians. covariance: of delta in map_from_body *
// exp_pose(delta), in the map's lengths. The covariance of the registration is added as independent.
Matrix6 covariance_on_plan(const PlanRegistration& registration, const Pose& map_from_body, const Matrix6& covariance);

// Covariance of a map point's x and y on the plan, square metres.
Eigen::Matrix2d plan_covariance_at(const PlanRegistration& registration, const Eigen::Vector3d& point_in_map);

// Derivatives of a point's position on the plan, height included, by the parameters of PlanRegistration::covariance.
using PlanJacobian = Eigen::Matrix<double, 3, 7>;
PlanJacobian plan_jacobian(const Similarity& plan_from_map, const Eigen::Vector3d& point_in_map);

// Second point of a wall. In the map and on the plan the wall is the line through both; the points need not coincide.
struct PlanWall {
  Eigen::Vector3d end_in_map = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_in_map = Eigen::Matrix3d::Zero();  // as of PlanCorrespondence
  Eigen::Vector2d end_in_plan = Eigen::Vector2d::Zero();        // metres
};

// A point of the map that was picked on the floor plan, or a wall.
struct PlanCorrespondence {
  std::string name;
  Eigen::Vector3d point_in_map = Eigen::Vector3d::Zero();
  Eigen::Vector2d point_in_plan = Eigen::Vector2d::Zero();  // metres
  double sigma = 0.05;  // metres, of x and of y, in the map and on the plan together
  // Covariance of point_in_map in the map's unit, in addition to sigma.
  Eigen::Matrix3d covariance_in_map = Eigen::Matrix3d::Zero();
  std::optional<PlanWall> wall = {};
};

struct PlanRegistrationOptions {
  double body_height = 0.0;         // metres, of the body's origin above the floor
  double body_height_sigma = 0.05;  // metres
};

struct PlanResidual {
  // By the map less as picked, metres; of a wall the larger distance from its line.
  Eigen::Vector2d error_in_plan = Eigen::Vector2d::Zero();
  bool is_outlier = false;  // excluded from the fit
  double sigma = 0.0;       // metres, standard deviation of the error per axis, without that of the registration
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

}  // namespace byre
