#include "byre/optimise/bundle_adjustment.h"

#include "byre/optimise/bundle_cost.h"
#include "byre/optimise/bundle_covariance.h"
#include "byre/optimise/bundle_roles.h"
#include "byre/optimise/bundle_schur.h"
#include "byre/optimise/ceres_problem.h"
#include "byre/optimise/reduced_system.h"
#include "byre/optimise/rotation_manifold.h"

#include <algorithm>
#include <cassert>
#include <deque>
#include <limits>
#include <utility>

#include <ceres/iteration_callback.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <ceres/types.h>

namespace byre {

namespace {

// Ends the solution when asked to; Ceres asks after each iteration.
class StopWhenAsked final : public ceres::IterationCallback {
 public:
  explicit StopWhenAsked(const std::function<bool()>& should_stop) : should_stop_(should_stop) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return should_stop_() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  const std::function<bool()>& should_stop_;  // owned by the caller
};

// Ceres' view of a problem whose calibration is sought: blocks of parameters and the costs between them. Lives for one
// call.
class CalibrationBundle {
 public:
  CalibrationBundle(const BundleProblem& problem, const BundleRoles& roles, const std::optional<HeldDistance>& scale,
                    double huber_width)
      : roles_(roles), loss_(huber_width), ceres_(borrowing_problem()) {
    for (const BundlePose& pose : problem.poses) poses_.push_back(pose.camera_from_world);
    for (const BundlePoint& point : problem.points) points_.push_back(point.position_in_world);
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (roles.pose_moves[i]) ceres_.AddParameterBlock(rotation(i), 4, &manifold_);
    }
    for (const int i : roles.observations) {
      const BundleObservation& observation = problem.observations[i];
      const int rig = problem.poses[observation.pose].rig;
      if (problem.calibration->rig == rig) {
        add(observation, problem.rigs[rig], *problem.calibration->sensitivity);
      } else {
        add(observation, problem.rigs[rig]);
      }
    }
    if (scale) hold(*scale);
    expect(*problem.calibration);
  }

  ceres::Solver::Summary solve(const BundleOptions& options) {
    ceres::Solver::Options how;
    how.linear_solver_type = linear_solver();
    // The camera system of a whole map fills up, so it takes CHOLMOD's dense blocks: Eigen takes ten times as long.
    if (ceres::IsSparseLinearAlgebraLibraryTypeAvailable(ceres::SUITE_SPARSE)) {
      how.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
    }
    how.linear_solver_ordering.reset(points_before_poses());
    how.max_num_iterations = options.max_iterations;
    how.num_threads = options.threads;
    how.jacobi_scaling = false;  // the damping is in proportion to the diagonal anyway
    how.logging_type = ceres::SILENT;
    StopWhenAsked stop_when_asked(options.should_stop);
    if (options.should_stop) how.callbacks.push_back(&stop_when_asked);
    ceres::Solver::Summary summary;
    ceres::Solve(how, &ceres_, &summary);
    return summary;
  }

  BundleSolution solution() const { return {poses_, points_, 0, false}; }
  const CalibrationVector& calibration_change() const { return calibration_; }

 private:
  double* rotation(std::size_t pose) { return poses_[pose].rotation.coeffs().data(); }
  double* translation(std::size_t pose) { return poses_[pose].translation.data(); }
  double* position(std::size_t point) { return points_[point].data(); }
  std::vector<double*> calibration_blocks() {
    std::vector<double*> blocks;
    for (int i = 0; i < kCalibrationBlocks; ++i) blocks.push_back(calibration_.data() + 3 * i);
    return blocks;
  }

  void add(const BundleObservation& observation, const Rig& rig) {
    assert(rig.is_stereo() || !observation.is_stereo());
    const Reprojection reprojection(rig, observation.measured, observation.pixel_sigma, observation.disparity_sigma);
    ceres::LossFunction* const loss = loss_of(observation);
    const auto [pose, point] = std::pair(observation.pose, observation.point);
    if (!roles_.point_moves[point]) {
      auto& cost = pose_costs_.emplace_back(reprojection, points_[point]);
      ceres_.AddResidualBlock(&cost, loss, rotation(pose), translation(pose));
    } else if (!roles_.pose_moves[pose]) {
      auto& cost = point_costs_.emplace_back(reprojection, poses_[pose]);
      ceres_.AddResidualBlock(&cost, loss, position(point));
    } else {
      auto& cost = pose_and_point_costs_.emplace_back(reprojection);
      ceres_.AddResidualBlock(&cost, loss, rotation(pose), translation(pose), position(point));
    }
  }

  // Through the rig whose calibration is sought; what does not move is held constant.
  void add(const BundleObservation& observation, const Rig& rig, const CalibrationSensitivity& sensitivity) {
    const auto [pose, point] = std::pair(observation.pose, observation.point);
    auto& cost = calibration_costs_.emplace_back(rig, sensitivity, observation);
    std::vector<double*> blocks = {rotation(pose), translation(pose), position(point)};
    const std::vector<double*> of_calibration = calibration_blocks();
    blocks.insert(blocks.end(), of_calibration.begin(), of_calibration.end());
    ceres_.AddResidualBlock(&cost, loss_of(observation), blocks);
    if (!roles_.pose_moves[pose]) {
      ceres_.SetParameterBlockConstant(rotation(pose));
      ceres_.SetParameterBlockConstant(translation(pose));
    }
    if (!roles_.point_moves[point]) ceres_.SetParameterBlockConstant(position(point));
  }

  void expect(const BundleCalibration& calibration) {
    calibration_prior_.emplace(calibration.expected, calibration.information);
    ceres_.AddResidualBlock(&*calibration_prior_, nullptr, calibration_blocks());
  }

  void hold(const HeldDistance& scale) {
    const auto pose = static_cast<std::size_t>(scale.pose);
    distance_cost_.emplace(scale.place_in_world, scale.distance, scale.sigma());
    ceres_.AddResidualBlock(&*distance_cost_, nullptr, rotation(pose), translation(pose));
  }

  ceres::LossFunction* loss_of(const BundleObservation& observation) {
    if (observation.weight == 1.0) return &loss_;
    return &weighted_losses_.emplace_back(&loss_, observation.weight, ceres::DO_NOT_TAKE_OWNERSHIP);
  }

  // The Schur complement needs both kinds; with one kind alone the normal matrix is sparse as it stands.
  ceres::LinearSolverType linear_solver() const {
    const auto poses = std::ranges::count(roles_.pose_moves, true);
    const auto points = std::ranges::count(roles_.point_moves, true);
    if (poses == 0 || points == 0) return ceres::SPARSE_NORMAL_CHOLESKY;
    return poses <= ReducedSystem::kMaxDensePoses ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  }

  ceres::ParameterBlockOrdering* points_before_poses() {
    auto* const order = new ceres::ParameterBlockOrdering;  // the solver's options own it
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (roles_.point_moves[i]) order->AddElementToGroup(position(i), 0);
    }
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (!roles_.pose_moves[i]) continue;
      order->AddElementToGroup(rotation(i), 1);
      order->AddElementToGroup(translation(i), 1);
    }
    for (double* const block : calibration_blocks()) order->AddElementToGroup(block, 1);
    return order;
  }

  const BundleRoles& roles_;  // owned by the caller, constant
  std::vector<Pose> poses_;   // written by Ceres, as are the points
  std::vector<Eigen::Vector3d> points_;
  CalibrationVector calibration_ = CalibrationVector::Zero();  // written by Ceres
  ceres::HuberLoss loss_;
  RotationManifold manifold_;
  // Deques, for Ceres holds the addresses of costs and losses.
  std::deque<ceres::ScaledLoss> weighted_losses_;
  std::deque<PoseAndPointCost> pose_and_point_costs_;
  std::deque<PoseCost> pose_costs_;
  std::deque<PointCost> point_costs_;
  std::deque<CalibrationCost> calibration_costs_;
  std::optional<DistanceCost> distance_cost_;
  std::optional<CalibrationPriorCost> calibration_prior_;
  ceres::Problem ceres_;  // last: refers to all of the above
};

BundleSolution solve_with_calibration(const BundleProblem& problem, const BundleRoles& roles,
                                      const std::optional<HeldDistance>& scale, const BundleOptions& options,
                                      CalibrationVector& calibration_change) {
  CalibrationBundle bundle(problem, roles, scale, options.huber_width);
  const ceres::Solver::Summary summary = bundle.solve(options);
  BundleSolution solution = bundle.solution();
  solution.iterations = std::max(0, static_cast<int>(summary.iterations.size()) - 1);  // the first is the start
  solution.usable = summary.IsSolutionUsable();
  if (solution.usable) calibration_change = bundle.calibration_change();
  return solution;
}

BundleResult unmoved(const BundleProblem& problem) {
  BundleResult result;
  for (const BundlePose& pose : problem.poses) result.camera_from_world.push_back(pose.camera_from_world);
  for (const BundlePoint& point : problem.points) result.points_in_world.push_back(point.position_in_world);
  result.usable = true;
  return result;
}

BundleResult solve(const BundleProblem& problem, const BundleRoles& roles, const std::optional<HeldDistance>& scale,
                   const BundleOptions& options) {
  BundleResult result = unmoved(problem);
  if (roles.observations.empty()) return result;
  const BundleSolution solution =
      problem.calibration ? solve_with_calibration(problem, roles, scale, options, result.calibration_change)
                          : solve_bundle(problem, roles, scale, options);
  result.iterations = solution.iterations;
  result.usable = solution.usable;
  if (!result.usable) return result;
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    if (roles.pose_moves[i]) result.camera_from_world[i] = solution.camera_from_world[i];
  }
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    if (roles.point_moves[i]) result.points_in_world[i] = solution.points_in_world[i];
  }
  return result;
}

// The problem at its solution, with the pose held for want of an anchor fixed.
BundleProblem moved(BundleProblem problem, const BundleResult& result, const BundleRoles& roles) {
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    problem.poses[i].camera_from_world = result.camera_from_world[i];
    problem.poses[i].fixed = !roles.pose_moves[i];
  }
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    problem.points[i].position_in_world = result.points_in_world[i];
  }
  return problem;
}

double squared_error(const BundleObservation& observation, const Rig& rig, const Eigen::Vector3d& point_in_camera) {
  if (point_in_camera.z() <= 0.0) return std::numeric_limits<double>::infinity();
  const StereoPixel error = rig.project(point_in_camera) - observation.measured;
  const double pixels = error.head<2>().squaredNorm() / (observation.pixel_sigma * observation.pixel_sigma);
  if (!observation.is_stereo()) return pixels;
  return pixels + error.z() * error.z() / (observation.disparity_sigma * observation.disparity_sigma);
}

std::vector<double> squared_errors(const BundleProblem& problem, const BundleResult& result) {
  std::vector<double> errors;
  errors.reserve(problem.observations.size());
  for (const BundleObservation& observation : problem.observations) {
    const Rig& rig = problem.rigs[problem.poses[observation.pose].rig];
    errors.push_back(squared_error(
        observation, rig, result.camera_from_world[observation.pose] * result.points_in_world[observation.point]));
  }
  return errors;
}

}  // namespace

BundleProblem with_change(BundleProblem problem, const CalibrationVector& change) {
  if (!problem.calibration) return problem;
  for (BundleObservation& observation : problem.observations) {
    if (problem.poses[observation.pose].rig != problem.calibration->rig) continue;
    const Eigen::Vector3d shift = problem.calibration->sensitivity->at(observation.measured).topRows<3>() * change;
    observation.measured.head<2>() -= shift.head<2>();
    if (observation.is_stereo()) observation.measured.z() -= shift.z();
  }
  problem.calibration.reset();
  return problem;
}

BundleResult bundle_adjust(const BundleProblem& problem, const BundleOptions& options) {
  const BundleRoles roles = choose_roles(problem);
  const std::optional<HeldDistance> scale = choose_scale(problem, roles);
  BundleResult result = solve(problem, roles, scale, options);
  std::optional<BundleProblem> changed;
  if (problem.calibration) changed = with_change(problem, result.calibration_change);
  const BundleProblem& calibrated = changed ? *changed : problem;
  result.squared_errors = squared_errors(calibrated, result);
  if (options.covariance_of_pose >= 0 && result.usable) {
    result.pose_covariance =
        marginal_covariance(moved(calibrated, result, roles), scale, options.covariance_of_pose, options.huber_width);
  }
  return result;
}

}  // namespace byre
