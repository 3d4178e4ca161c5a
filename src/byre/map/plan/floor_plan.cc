#include "byre/map/plan/floor_plan.h"

#include "byre/base/enum_names.h"
#include "byre/geometry/decompositions.h"
#include "byre/map/plan/planar_consensus.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace byre {
namespace {

using Correspondences = std::span<const PlanCorrespondence>;
using Vector7 = Eigen::Matrix<double, 7, 1>;

constexpr int kMostIterations = 20;
constexpr double kConverged = 1e-10;  // metres and radians
constexpr int kMostRounds = 5;
constexpr double kThinnest = 0.1;    // width of a line, relative to its length
constexpr double kLargestRms = 3.0;  // sigmas
constexpr double kFarthestReach = 3.0;
constexpr double kRoughest = 0.1;  // thickness of a path, relative to its width

// A level frame with its origin in the driving plane.
Pose level_from_map(const DrivingPlane& plane) {
  const Eigen::Quaterniond rotation = rotation_between(plane.up_in_map, Eigen::Vector3d::UnitZ()).normalized();
  return {rotation, -(rotation * plane.point_in_map)};
}

double largest_tilt_sigma(const DrivingPlane& plane) {
  return 1.0 / std::sqrt(symmetric_eigenvalues(plane.up_information)[0]);
}

PlanarPoint planar(const Eigen::Vector2d& point) {
  return {point.x(), point.y()};
}

// Standard deviation per axis of a point with the sigma of its pick. A free scale is unknown here: sigma alone.
double sigma_per_axis(double sigma, const Eigen::Matrix3d& covariance_in_map, Scale scale) {
  return scale == Scale::free ? sigma : std::sqrt(sigma * sigma + covariance_in_map.trace() / 3.0);
}

// Correspondences seen from above. The tilt's uncertainty adds to the sigma of points high above the floor. Walls add
// pairs if there are few points.
std::vector<PlanarPair> seen_from_above(Correspondences correspondences, const DrivingPlane& plane, Scale scale,
                                        const Eigen::Vector2d& offset_in_plan) {
  constexpr std::size_t kEnoughPoints = 4;  // one may be wrong
  const Pose level = level_from_map(plane);
  const double tilt = scale == Scale::fixed ? largest_tilt_sigma(plane) : 0.0;
  const auto pair_of = [&](const Eigen::Vector3d& point_in_map, const Eigen::Vector2d& point_in_plan, double sigma) {
    const Eigen::Vector3d point = level * point_in_map;
    return PlanarPair{planar(point.head<2>()), planar(point_in_plan - offset_in_plan),
                      std::hypot(sigma, tilt * point.z())};
  };
  std::vector<PlanarPair> points;
  std::vector<PlanarWall> walls;
  for (const PlanCorrespondence& each : correspondences) {
    const PlanarPair pair =
        pair_of(each.point_in_map, each.point_in_plan, sigma_per_axis(each.sigma, each.covariance_in_map, scale));
    if (each.wall) {
      walls.push_back({pair, pair_of(each.wall->end_in_map, each.wall->end_in_plan, pair.sigma)});
    } else {
      points.push_back(pair);
    }
  }
  if (points.size() >= kEnoughPoints) return points;
  const std::vector<PlanarPair> of_walls = pairs_of_walls(points, walls);
  points.insert(points.end(), of_walls.begin(), of_walls.end());
  return points;
}

Similarity lifted(const PlanarSimilarity& plan_from_level, const DrivingPlane& plane, Scale scale, double body_height) {
  const double yaw = std::arg(plan_from_level.turn);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  const Pose level = level_from_map(plane);
  Similarity plan_from_map;
  plan_from_map.scale = scale == Scale::fixed ? 1.0 : std::abs(plan_from_level.turn);
  plan_from_map.target_from_source.rotation = (turn * level.rotation).normalized();
  plan_from_map.target_from_source.translation =
      turn * (plan_from_map.scale * level.translation) +
      Eigen::Vector3d(plan_from_level.shift.real(), plan_from_level.shift.imag(), body_height);
  return plan_from_map;
}

struct NormalEquations {
  Matrix7 information = Matrix7::Zero();
  Vector7 gradient = Vector7::Zero();
  double cost = 0.0;

  template <int Rows>
  void add(const Eigen::Matrix<double, Rows, 7>& jacobian, const Eigen::Matrix<double, Rows, 1>& residual,
           const Eigen::Matrix<double, Rows, Rows>& weight) {
    information += jacobian.transpose() * weight * jacobian;
    gradient += jacobian.transpose() * weight * residual;
    cost += residual.dot(weight * residual);
  }
};

// Fit of the inliers; x and y of the plan are relative to an offset.
class PlanRefinement {
 public:
  PlanRefinement(Correspondences correspondences, const DrivingPlane& plane, Scale scale,
                 const PlanRegistrationOptions& options, const Eigen::Vector2d& offset_in_plan)
      : correspondences_(correspondences),
        plane_(plane),
        unknowns_(scale == Scale::free ? 7 : 6),
        options_(options),
        offset_in_plan_(offset_in_plan) {}

  Similarity refine(Similarity plan_from_map, const std::vector<bool>& is_inlier) const {
    for (int i = 0; i < kMostIterations; ++i) {
      NormalEquations all = picks(plan_from_map, is_inlier);
      add_plane(plan_from_map, all);
      Vector7 step = Vector7::Zero();
      step.head(unknowns_) =
          -all.information.topLeftCorner(unknowns_, unknowns_).ldlt().solve(all.gradient.head(unknowns_));
      plan_from_map.target_from_source = plan_from_map.target_from_source * exp_pose(step.head<6>());
      plan_from_map.scale *= std::exp(step[6]);
      if (step.norm() < kConverged) break;
    }
    return plan_from_map;
  }

  // Scales the covariance by the residuals, with a prior of two residuals of the expected size: few correspondences
  // that fit well by chance must not give a small covariance.
  Matrix7 covariance(const Similarity& plan_from_map, const std::vector<bool>& is_inlier) const {
    constexpr double kExpected = 2.0;
    NormalEquations all = picks(plan_from_map, is_inlier);
    const auto count = static_cast<double>(std::ranges::count(is_inlier, true));
    const double freedom = 2.0 * count - (unknowns_ - 3);  // height and tilt come from the plane
    all.information *= (kExpected + freedom) / (kExpected + all.cost);
    add_plane(plan_from_map, all);
    Matrix7 covariance = Matrix7::Zero();
    covariance.topLeftCorner(unknowns_, unknowns_) = all.information.topLeftCorner(unknowns_, unknowns_)
                                                         .ldlt()
                                                         .solve(Eigen::MatrixXd::Identity(unknowns_, unknowns_));
    return Matrix7(covariance.selfadjointView<Eigen::Upper>());
  }

  // Errors of a correspondence with their covariance, square metres: of a point x and y, of a wall the distances of its
  // start and end from the line on the plan.
  struct Measurement {
    Eigen::Vector2d error;
    Eigen::Matrix<double, 2, 7> jacobian;
    Eigen::Matrix2d covariance;
  };

  Measurement measure(const PlanCorrespondence& each, const Similarity& plan_from_map) const {
    Measurement start = measure_point(each.point_in_map, each.covariance_in_map, each, plan_from_map);
    if (!each.wall) return start;
    const Measurement end = measure_point(each.wall->end_in_map, each.wall->covariance_in_map, each, plan_from_map);
    const Eigen::RowVector2d normal = normal_of(each).transpose();
    Measurement wall;
    wall.error << normal * start.error, normal * end.error;
    wall.jacobian << normal * start.jacobian, normal * end.jacobian;
    wall.covariance << normal * start.covariance * normal.transpose(), 0.0, 0.0,
        normal * end.covariance * normal.transpose();
    return wall;
  }

  PlanResidual residual(const PlanCorrespondence& each, const Similarity& plan_from_map) const {
    const Measurement measured = measure(each, plan_from_map);
    if (!each.wall) return {measured.error, false, std::sqrt(0.5 * measured.covariance.trace())};
    const int larger = std::abs(measured.error[1]) > std::abs(measured.error[0]) ? 1 : 0;
    return {measured.error[larger] * normal_of(each), false, std::sqrt(measured.covariance(larger, larger))};
  }

  // Lengths, in sigmas.
  std::vector<double> residuals(const Similarity& plan_from_map) const {
    std::vector<double> residuals;
    for (const PlanCorrespondence& each : correspondences_) {
      const Measurement measured = measure(each, plan_from_map);
      residuals.push_back(std::sqrt(measured.error.dot(measured.covariance.inverse() * measured.error)));
    }
    return residuals;
  }

 private:
  Measurement measure_point(const Eigen::Vector3d& point_in_map, const Eigen::Matrix3d& covariance_in_map,
                            const PlanCorrespondence& each, const Similarity& plan_from_map) const {
    const Eigen::Matrix<double, 2, 3> rotation =
        plan_from_map.scale * plan_from_map.target_from_source.rotation.toRotationMatrix().topRows<2>();
    return {
        (plan_from_map * point_in_map).head<2>() - (each.point_in_plan - offset_in_plan_),
        plan_jacobian(plan_from_map, point_in_map).topRows<2>(),
        rotation * covariance_in_map * rotation.transpose() + each.sigma * each.sigma * Eigen::Matrix2d::Identity()};
  }

  static Eigen::Vector2d normal_of(const PlanCorrespondence& each) {
    const Eigen::Vector2d along = (each.wall->end_in_plan - each.point_in_plan).normalized();
    return {-along.y(), along.x()};
  }

  NormalEquations picks(const Similarity& plan_from_map, const std::vector<bool>& is_inlier) const {
    NormalEquations equations;
    for (std::size_t i = 0; i < correspondences_.size(); ++i) {
      if (!is_inlier[i]) continue;
      const Measurement measured = measure(correspondences_[i], plan_from_map);
      equations.add<2>(measured.jacobian, measured.error, measured.covariance.inverse());
    }
    return equations;
  }

  // Constrains the height of the body's path and the up direction.
  void add_plane(const Similarity& plan_from_map, NormalEquations& equations) const {
    const Eigen::Matrix3d rotation = plan_from_map.target_from_source.rotation.toRotationMatrix();
    const Eigen::Matrix<double, 1, 7> height_jacobian =
        plan_jacobian(plan_from_map, plane_.point_in_map).bottomRows<1>();
    const double height = (plan_from_map * plane_.point_in_map).z() - options_.body_height;
    const double height_weight = 1.0 / (options_.body_height_sigma * options_.body_height_sigma);
    equations.add<1>(height_jacobian, Eigen::Matrix<double, 1, 1>(height), Eigen::Matrix<double, 1, 1>(height_weight));

    Eigen::Matrix<double, 2, 7> tilt_jacobian = Eigen::Matrix<double, 2, 7>::Zero();
    tilt_jacobian.block<2, 3>(0, 3) = (-rotation * skew(plane_.up_in_map)).topRows<2>();
    const Eigen::Vector2d tilt = (rotation * plane_.up_in_map).head<2>();
    const Eigen::Matrix3d weight = rotation * plane_.up_information * rotation.transpose();
    equations.add<2>(tilt_jacobian, tilt, weight.topLeftCorner<2, 2>());
  }

  Correspondences correspondences_;
  const DrivingPlane& plane_;
  int unknowns_;
  PlanRegistrationOptions options_;
  Eigen::Vector2d offset_in_plan_;
};

std::vector<bool> within(const std::vector<double>& residuals) {
  const double limit = largest_agreeing_residual(residuals);
  std::vector<bool> is_inlier;
  for (const double residual : residuals) is_inlier.push_back(residual <= limit);
  return is_inlier;
}

std::vector<Eigen::Vector2d> used_points(Correspondences correspondences, const PlanFit& fit) {
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < correspondences.size(); ++i) {
    if (fit.residuals[i].is_outlier) continue;
    points.push_back(correspondences[i].point_in_plan);
    if (correspondences[i].wall) points.push_back(correspondences[i].wall->end_in_plan);
  }
  return points;
}

Eigen::Vector2d mean_of_picks(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

bool lie_in_line(const std::vector<Eigen::Vector2d>& points) {
  const Eigen::Vector2d mean = mean_of_picks(points);
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& point : points) scatter += (point - mean) * (point - mean).transpose();
  const Eigen::Vector2d spread = symmetric_eigenvalues(scatter);
  return spread[0] < kThinnest * kThinnest * spread[1];
}

// Whether the body's path extends far beyond the points.
bool lie_in_a_corner(const std::vector<Eigen::Vector2d>& points, const DrivingPlane& plane,
                     const Similarity& plan_from_map) {
  const Eigen::Vector2d centre = mean_of_picks(points);
  double reach_of_points = 0.0, reach_of_path = 0.0;
  for (const Eigen::Vector2d& point : points) reach_of_points = std::max(reach_of_points, (point - centre).norm());
  for (const Eigen::Vector3d& position_in_map : plane.path_in_map) {
    const Eigen::Vector3d position_in_plan = plan_from_map * position_in_map;
    reach_of_path = std::max(reach_of_path, (position_in_plan.head<2>() - centre).norm());
  }
  return reach_of_path > kFarthestReach * reach_of_points;
}

// Whether the inliers' residuals are small and most correspondences are inliers.
bool agree(Correspondences correspondences, const PlanFit& fit) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < correspondences.size(); ++i) {
    if (fit.residuals[i].is_outlier) continue;
    sum += fit.residuals[i].error_in_plan.squaredNorm() / (fit.residuals[i].sigma * fit.residuals[i].sigma);
    ++count;
  }
  return sum <= kLargestRms * kLargestRms * static_cast<double>(count) && 3 * count >= 2 * correspondences.size();
}

std::vector<PlanDoubt> doubts_about(Correspondences correspondences, const DrivingPlane& plane, const PlanFit& fit) {
  const std::vector<Eigen::Vector2d> used = used_points(correspondences, fit);
  std::vector<PlanDoubt> doubts;
  if (std::ranges::count(fit.residuals, false, &PlanResidual::is_outlier) < 3) {
    doubts.push_back(PlanDoubt::few_points);
  } else if (lie_in_line(used)) {
    doubts.push_back(PlanDoubt::in_line);
  }
  if (lie_in_a_corner(used, plane, fit.registration.plan_from_map)) doubts.push_back(PlanDoubt::in_a_corner);
  if (!agree(correspondences, fit)) doubts.push_back(PlanDoubt::disagreement);
  const bool is_line = plane.width < kThinnest * plane.length;
  if (!is_line && plane.thickness > kRoughest * plane.width) doubts.push_back(PlanDoubt::uneven_path);
  return doubts;
}

}  // namespace

std::string_view to_string(PlanDoubt doubt) {
  return name_among<PlanDoubt::uneven_path>(
      {"fewer than three correspondences are used, so errors cannot be detected: pick more",
       "the correspondences are nearly collinear: pick some to the side of the line",
       "the correspondences cover a small part of the map: pick some at its other end",
       "the correspondences are inconsistent: check them, the scale of the plan and the scale of the map",
       "the path is not planar: the up direction is taken from the orientation of the camera"},
      doubt);
}

double residual_of(const PlanFit& fit) {
  const auto outliers = static_cast<std::size_t>(std::ranges::count(fit.residuals, true, &PlanResidual::is_outlier));
  const std::size_t count = fit.residuals.size();
  const bool are_told_apart = outliers == 0 || (count > 3 && 3 * outliers <= count);
  if (are_told_apart || count == 0) return fit.rms;
  double squares = 0.0;
  for (const PlanResidual& residual : fit.residuals) squares += residual.error_in_plan.squaredNorm();
  return std::sqrt(squares / static_cast<double>(count));
}

bool has_large_residual(const PlanFit& fit) {
  return residual_of(fit) > kLargePlanResidual;
}

std::optional<PlanFit> register_on_plan(Correspondences correspondences, const DrivingPlane& plane, Scale scale,
                                        const PlanRegistrationOptions& options) {
  if (correspondences.size() < 2) return std::nullopt;
  const Eigen::Vector2d offset_in_plan = correspondences.front().point_in_plan;  // may be millions of metres
  const auto consensus = find_planar_consensus(seen_from_above(correspondences, plane, scale, offset_in_plan), scale);
  if (!consensus) return std::nullopt;
  Similarity start = lifted(*consensus, plane, scale, options.body_height);
  start.target_from_source.translation.head<2>() += offset_in_plan;
  return register_from(start, correspondences, plane, scale, options);
}

PlanFit register_from(const Similarity& start, Correspondences correspondences, const DrivingPlane& plane, Scale scale,
                      const PlanRegistrationOptions& options) {
  const Eigen::Vector2d offset_in_plan = correspondences.front().point_in_plan;
  const PlanRefinement refinement(correspondences, plane, scale, options, offset_in_plan);
  Similarity plan_from_map = start;
  plan_from_map.target_from_source.translation.head<2>() -= offset_in_plan;
  std::vector<bool> is_inlier = within(refinement.residuals(plan_from_map));
  plan_from_map = refinement.refine(plan_from_map, is_inlier);
  for (int round = 0; round < kMostRounds; ++round) {
    const std::vector<bool> next = within(refinement.residuals(plan_from_map));
    if (next == is_inlier || std::ranges::count(next, true) < 2) break;
    is_inlier = next;
    plan_from_map = refinement.refine(plan_from_map, is_inlier);
  }

  PlanFit fit;
  double squares = 0.0;
  for (std::size_t i = 0; i < correspondences.size(); ++i) {
    fit.residuals.push_back(refinement.residual(correspondences[i], plan_from_map));
    fit.residuals.back().is_outlier = !is_inlier[i];
    if (is_inlier[i]) squares += fit.residuals.back().error_in_plan.squaredNorm();
  }
  fit.rms = std::sqrt(squares / static_cast<double>(std::ranges::count(is_inlier, true)));
  fit.registration.covariance = refinement.covariance(plan_from_map, is_inlier);
  plan_from_map.target_from_source.translation.head<2>() += offset_in_plan;
  fit.registration.plan_from_map = plan_from_map;
  fit.doubts = doubts_about(correspondences, plane, fit);
  return fit;
}

}  // namespace byre
