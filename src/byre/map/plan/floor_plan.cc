#include "byre/map/plan/floor_plan.h"

#include "byre/geometry/decompositions.h"
#include "byre/geometry/median.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Cholesky>

namespace byre {
namespace {

// A position seen from above in two frames, x and y as real and imaginary part.
struct PlanarPair {
  std::complex<double> in_source;
  std::complex<double> in_target;
  double sigma = 1.0;  // standard error per axis, in the target
};

// in_target = turn * in_source + shift. The argument of turn is the rotation, its magnitude the scale.
struct PlanarSimilarity {
  std::complex<double> turn = 1.0;
  std::complex<double> shift = 0.0;
};

// Pairs consistent with one planar similarity or rigid motion.
struct PlanarConsensus {
  PlanarSimilarity target_from_source;  // least squares over the inliers
  std::vector<bool> is_inlier;          // one per pair
};

using Complex = std::complex<double>;
using Pairs = std::span<const PlanarPair>;
using Subset = std::vector<std::size_t>;  // indices of pairs
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

constexpr double kRayleighMedian = 1.1774;  // median length of a vector of two standard normal variables
constexpr double kRayleigh99 = 3.0349;      // 99 % quantile of that length
constexpr std::size_t kMostSubsets = 20000;
constexpr int kMostSteps = 20;

// Least squares weighted by 1/sigma^2; Umeyama's solution in the plane. Empty if all pairs coincide in one frame.
std::optional<PlanarSimilarity> fit(Pairs pairs, const Subset& subset, Scale scale) {
  Complex source_sum = 0.0, target_sum = 0.0;
  double weights = 0.0;
  for (const std::size_t i : subset) {
    const double weight = 1.0 / (pairs[i].sigma * pairs[i].sigma);
    source_sum += weight * pairs[i].in_source;
    target_sum += weight * pairs[i].in_target;
    weights += weight;
  }
  const Complex source_mean = source_sum / weights, target_mean = target_sum / weights;
  Complex product = 0.0;
  double source_variance = 0.0;
  for (const std::size_t i : subset) {
    const double weight = 1.0 / (pairs[i].sigma * pairs[i].sigma);
    const Complex source = pairs[i].in_source - source_mean;
    product += weight * (pairs[i].in_target - target_mean) * std::conj(source);
    source_variance += weight * std::norm(source);
  }
  const double length = scale == Scale::free ? source_variance : std::abs(product);
  if (!(std::abs(product) > 0.0) || !(length > 0.0)) return std::nullopt;
  const Complex turn = product / length;
  return PlanarSimilarity{turn, target_mean - turn * source_mean};
}

// Lengths, in sigmas.
std::vector<double> residuals_of(Pairs pairs, const PlanarSimilarity& motion) {
  std::vector<double> residuals;
  for (const PlanarPair& pair : pairs) {
    residuals.push_back(std::abs(motion.turn * pair.in_source + motion.shift - pair.in_target) / pair.sigma);
  }
  return residuals;
}

// Size of the half of `count` pairs, two of which determine a motion. In a larger subset outliers might be a majority.
std::size_t trusted_half(std::size_t count) {
  return std::min((count + 3) / 2, count);
}

struct TrimmedFit {
  PlanarSimilarity motion;
  Subset nearest;  // indices of the half with the best fit, ascending
  double cost = std::numeric_limits<double>::infinity();
};

TrimmedFit trim(Pairs pairs, const PlanarSimilarity& motion) {
  const std::vector<double> residuals = residuals_of(pairs, motion);
  TrimmedFit trimmed{motion, Subset(pairs.size()), 0.0};
  std::iota(trimmed.nearest.begin(), trimmed.nearest.end(), std::size_t{0});
  std::ranges::stable_sort(trimmed.nearest, {}, [&residuals](std::size_t i) { return residuals[i]; });
  trimmed.nearest.resize(trusted_half(pairs.size()));
  std::ranges::sort(trimmed.nearest);
  for (const std::size_t i : trimmed.nearest) trimmed.cost += residuals[i] * residuals[i];
  return trimmed;
}

// The best motion determined by two pairs. With very many pairs only some of the sets are tried.
std::optional<TrimmedFit> best_of_twos(Pairs pairs, Scale scale) {
  const std::size_t stride = 1 + pairs.size() * pairs.size() / 2 / kMostSubsets;
  std::optional<TrimmedFit> best;
  std::size_t count = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (std::size_t j = i + 1; j < pairs.size(); ++j) {
      if (count++ % stride != 0) continue;
      const std::optional<PlanarSimilarity> motion = fit(pairs, {i, j}, scale);
      if (!motion) continue;
      TrimmedFit trimmed = trim(pairs, *motion);
      if (!best || trimmed.cost < best->cost) best = std::move(trimmed);
    }
  }
  return best;
}

TrimmedFit concentrate(Pairs pairs, TrimmedFit best, Scale scale) {
  for (int step = 0; step < kMostSteps; ++step) {
    const std::optional<PlanarSimilarity> motion = fit(pairs, best.nearest, scale);
    if (!motion) break;
    TrimmedFit better = trim(pairs, *motion);
    if (!(better.cost < best.cost)) break;
    best = std::move(better);
  }
  return best;
}

// Bound of inlier residuals, in the given sigmas: the 99 % quantile for normally distributed errors. More than three
// sigmas if more than a few residuals exceed their sigmas.
double largest_agreeing_residual(std::vector<double> residuals) {
  const auto count = static_cast<double>(residuals.size());
  // Finite-sample correction for the exact fit to two pairs, which lowers the residuals (Rousseeuw and Leroy 1987).
  const double few = count > 2.0 ? 1.0 + 5.0 / (count - 2.0) : 1.0;
  return kRayleigh99 * std::max(1.0, few * median(std::move(residuals)) / kRayleighMedian);
}

// Least trimmed squares: of the motions determined by two pairs, the one that best fits its nearest half of the pairs,
// improved by refits to that half (Rousseeuw and Van Driessen 2006, theorem 1). Empty if no two pairs are separate in
// both frames.
std::optional<PlanarConsensus> find_planar_consensus(Pairs pairs, Scale scale) {
  const std::optional<TrimmedFit> start = best_of_twos(pairs, scale);
  if (!start) return std::nullopt;
  const TrimmedFit trimmed = concentrate(pairs, *start, scale);
  const std::vector<double> residuals = residuals_of(pairs, trimmed.motion);
  const double limit = largest_agreeing_residual(residuals);
  PlanarConsensus consensus{trimmed.motion, {}};
  Subset inliers;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    consensus.is_inlier.push_back(residuals[i] <= limit);
    if (consensus.is_inlier.back()) inliers.push_back(i);
  }
  if (const auto motion = fit(pairs, inliers, scale)) consensus.target_from_source = *motion;
  return consensus;
}

double largest_tilt_sigma(const DrivingPlane& plane) {
  return 1.0 / std::sqrt(symmetric_eigenvalues(plane.up_information)[0]);
}

// Correspondences seen from above. The tilt's uncertainty adds to the sigma of points high above the floor.
std::vector<PlanarPair> seen_from_above(Correspondences correspondences, const DrivingPlane& plane, Scale scale,
                                        const Eigen::Vector2d& offset_in_plan) {
  const Pose level = level_from_map(plane);
  const double tilt = scale == Scale::fixed ? largest_tilt_sigma(plane) : 0.0;
  std::vector<PlanarPair> pairs;
  for (const PlanCorrespondence& each : correspondences) {
    const Eigen::Vector3d point = level * each.point_in_map;
    const Eigen::Vector2d target = each.point_in_plan - offset_in_plan;
    pairs.push_back({{point.x(), point.y()}, {target.x(), target.y()}, std::hypot(each.sigma, tilt * point.z())});
  }
  return pairs;
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

  Eigen::Vector2d error_of(const PlanCorrespondence& each, const Similarity& plan_from_map) const {
    return (plan_from_map * each.point_in_map).head<2>() - (each.point_in_plan - offset_in_plan_);
  }

  // Lengths, in sigmas.
  std::vector<double> residuals(const Similarity& plan_from_map) const {
    std::vector<double> residuals;
    for (const PlanCorrespondence& each : correspondences_) {
      residuals.push_back(error_of(each, plan_from_map).norm() / each.sigma);
    }
    return residuals;
  }

 private:
  NormalEquations picks(const Similarity& plan_from_map, const std::vector<bool>& is_inlier) const {
    NormalEquations equations;
    for (std::size_t i = 0; i < correspondences_.size(); ++i) {
      if (!is_inlier[i]) continue;
      const PlanCorrespondence& each = correspondences_[i];
      const Eigen::Matrix<double, 2, 7> jacobian = plan_jacobian(plan_from_map, each.point_in_map).topRows<2>();
      equations.add<2>(jacobian, error_of(each, plan_from_map),
                       Eigen::Matrix2d::Identity() / (each.sigma * each.sigma));
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
    if (!fit.residuals[i].is_outlier) points.push_back(correspondences[i].point_in_plan);
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
    sum += fit.residuals[i].error_in_plan.squaredNorm() / (correspondences[i].sigma * correspondences[i].sigma);
    ++count;
  }
  return sum <= kLargestRms * kLargestRms * static_cast<double>(count) && 3 * count >= 2 * correspondences.size();
}

std::vector<PlanDoubt> doubts_about(Correspondences correspondences, const DrivingPlane& plane, const PlanFit& fit) {
  const std::vector<Eigen::Vector2d> used = used_points(correspondences, fit);
  std::vector<PlanDoubt> doubts;
  if (used.size() < 3) {
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
  switch (doubt) {
    case PlanDoubt::few_points:
      return "fewer than three correspondences are used, so errors cannot be detected: pick more";
    case PlanDoubt::in_line:
      return "the correspondences are nearly collinear: pick some to the side of the line";
    case PlanDoubt::in_a_corner:
      return "the correspondences cover a small part of the map: pick some at its other end";
    case PlanDoubt::disagreement:
      return "the correspondences are inconsistent: check them, the scale of the plan and the scale of the map";
    case PlanDoubt::uneven_path:
      return "the path is not planar: the up direction is taken from the orientation of the camera";
  }
  return "";
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

  const PlanRefinement refinement(correspondences, plane, scale, options, offset_in_plan);
  std::vector<bool> is_inlier = consensus->is_inlier;
  Similarity plan_from_map =
      refinement.refine(lifted(consensus->target_from_source, plane, scale, options.body_height), is_inlier);
  for (int round = 0; round < kMostRounds; ++round) {
    const std::vector<bool> next = within(refinement.residuals(plan_from_map));
    if (next == is_inlier || std::ranges::count(next, true) < 2) break;
    is_inlier = next;
    plan_from_map = refinement.refine(plan_from_map, is_inlier);
  }

  PlanFit fit;
  double squares = 0.0;
  for (std::size_t i = 0; i < correspondences.size(); ++i) {
    fit.residuals.push_back({refinement.error_of(correspondences[i], plan_from_map), !is_inlier[i]});
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
