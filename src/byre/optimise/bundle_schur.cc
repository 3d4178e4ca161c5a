#include "byre/optimise/bundle_schur.h"

#include "byre/optimise/bundle_estimate.h"
#include "byre/optimise/bundle_motion.h"
#include "byre/optimise/calibration_border.h"
#include "byre/optimise/reduced_system.h"
#include "byre/optimise/reprojection.h"
#include "byre/optimise/robust_error.h"
#include "byre/optimise/trust_region.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace byre {
namespace {

using Matrix63 = Eigen::Matrix<double, 6, 3>;

// Most points whose equations are kept until back-substitution. Those of a million would double the points' memory.
constexpr std::size_t kMostKept = 100000;

// State of the solver; lives for one call.
class SchurBundle {
 public:
  SchurBundle(const BundleProblem& problem, const BundleRoles& roles, const std::optional<FixedDistance>& scale,
              double huber_width)
      : problem_(problem), scale_(scale), huber_width_(huber_width) {
    give_slots(roles);
    begin_estimate();
    for (const BundlePose& pose : problem.poses) rigs_.push_back(&problem.rigs[static_cast<std::size_t>(pose.rig)]);
    for (const int i : roles.motions) motions_.push_back(&problem.motions[static_cast<std::size_t>(i)]);
    make_tracks(roles);
    if (tracks_.size() <= kMostKept) kept_.resize(tracks_.size());
    reduced_.emplace(slot_count_, neighbours());
    if (problem.calibration) border_.emplace(problem, slot_count_);
  }

  BundleEstimate take_estimate() { return std::move(estimate_); }  // to be called once, at the end
  double cost() const { return cost_of(estimate_); }

  // Builds the damped normal equations and eliminates the points. Returns the largest gradient component.
  double linearise(double radius);
  // Empty if the equations have no solution.
  std::optional<BundleStep> solve();
  // Covariances of delta in exp_pose(delta) * camera_from_world, one per pose. Empty if the equations have no solution.
  std::vector<Matrix6> covariances(const std::vector<int>& poses);
  BundleEstimate moved(const BundleStep& step) const;
  double cost_of(const BundleEstimate& estimate) const;
  void set_estimate(BundleEstimate estimate) { estimate_ = std::move(estimate); }
  double squared_length() const;  // sum over all moving parameters

 private:
  void give_slots(const BundleRoles& roles);
  void begin_estimate();
  void make_tracks(const BundleRoles& roles);
  std::vector<std::vector<int>> neighbours() const;  // see ReducedSystem
  LinearObservation linearised(const BundleTerm& term, const Eigen::Vector3d& point) const;
  void linearise_track(std::size_t index);
  void eliminate(std::size_t index, const PointEquations& equations);
  bool solve_point(std::size_t index, BundleStep& step);
  bool solve_poses(BundleStep& step);
  void add_scale();
  void add_motion(const BundleMotion& motion);
  double cost_of_motions(const BundleEstimate& estimate) const;

  const BundleObservation& observation_of(const BundleTerm& term) const {
    return problem_.observations[static_cast<std::size_t>(term.seen)];
  }
  Reprojection reprojection_of(const BundleObservation& seen) const {
    return Reprojection(*rigs_[static_cast<std::size_t>(seen.pose)], seen.measured, seen.pixel_sigma,
                        seen.disparity_sigma);
  }

  const BundleProblem& problem_;  // owned by the caller
  std::vector<const Rig*> rigs_;  // one per pose; constant after construction, as are the next seven
  std::optional<FixedDistance> scale_;
  double huber_width_ = 0.0;
  std::vector<int> slots_;  // one per pose
  int slot_count_ = 0;
  std::vector<BundleTrack> tracks_;
  std::vector<BundleTerm> terms_;
  std::vector<const BundleMotion*> motions_;  // owned by the caller

  BundleEstimate estimate_;
  // Written by linearise().
  std::optional<ReducedSystem> reduced_;  // with the points eliminated
  std::vector<Matrix6> own_;              // one per pose: normal matrix before the points are eliminated
  Eigen::VectorXd gradient_;              // by the poses
  Eigen::VectorXd eliminated_;            // part of the gradient removed by the elimination of the points
  Eigen::VectorXd damping_;               // added to the diagonal of reduced_
  double radius_ = 0.0;
  std::vector<PointEquations> kept_;         // one per track; empty with more than kMostKept tracks
  std::vector<Matrix63> between_;            // one per term of the current track: normal matrix between pose and point
  std::optional<CalibrationBorder> border_;  // empty without self-calibration
  double largest_slope_ = 0.0;
};

void SchurBundle::give_slots(const BundleRoles& roles) {
  slots_.assign(roles.pose_moves.size(), -1);
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (roles.pose_moves[i]) slots_[i] = slot_count_++;
  }
}

void SchurBundle::begin_estimate() {
  estimate_.poses.reserve(problem_.poses.size());
  estimate_.points.reserve(problem_.points.size());
  for (const BundlePose& pose : problem_.poses) estimate_.poses.push_back(pose.camera_from_world);
  for (const BundlePoint& point : problem_.points) estimate_.points.push_back(point.position_in_world);
  estimate_.update_rotations();
}

void SchurBundle::make_tracks(const BundleRoles& roles) {
  terms_.reserve(roles.observations.size());
  tracks_.reserve(problem_.points.size());
  for (const int i : roles.observations) {
    const BundleObservation& seen = problem_.observations[static_cast<std::size_t>(i)];
    if (tracks_.empty() || tracks_.back().point != seen.point) {
      tracks_.push_back({seen.point, static_cast<std::uint32_t>(terms_.size()), 0,
                         roles.point_moves[static_cast<std::size_t>(seen.point)]});
    }
    terms_.push_back({i, slots_[static_cast<std::size_t>(seen.pose)]});
    tracks_.back().end = static_cast<std::uint32_t>(terms_.size());
  }
}

std::vector<std::vector<int>> SchurBundle::neighbours() const {
  if (slot_count_ <= ReducedSystem::kMaxDensePoses) return {};
  const auto count = static_cast<std::size_t>(slot_count_);
  std::vector<std::vector<std::size_t>> tracks_of_slot(count);
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    if (!tracks_[t].moves) continue;
    for (std::size_t i = tracks_[t].begin; i < tracks_[t].end; ++i) {
      if (terms_[i].slot >= 0) tracks_of_slot[static_cast<std::size_t>(terms_[i].slot)].push_back(t);
    }
  }
  std::vector<std::vector<int>> neighbours(count);
  std::vector<int> found_by(count, -1);
  for (int row = 0; row < slot_count_; ++row) {
    std::vector<int>& columns = neighbours[static_cast<std::size_t>(row)];
    for (const std::size_t t : tracks_of_slot[static_cast<std::size_t>(row)]) {
      for (std::size_t i = tracks_[t].begin; i < tracks_[t].end; ++i) {
        const int column = terms_[i].slot;
        if (column < 0 || column >= row || found_by[static_cast<std::size_t>(column)] == row) continue;
        found_by[static_cast<std::size_t>(column)] = row;
        columns.push_back(column);
      }
    }
    std::ranges::sort(columns);
  }
  for (const BundleMotion* const motion : motions_) {
    const auto [column, row] =
        std::minmax(slots_[static_cast<std::size_t>(motion->earlier)], slots_[static_cast<std::size_t>(motion->later)]);
    if (column < 0) continue;
    std::vector<int>& columns = neighbours[static_cast<std::size_t>(row)];
    const auto place = std::ranges::lower_bound(columns, column);
    if (place == columns.end() || *place != column) columns.insert(place, column);
  }
  return neighbours;
}

LinearObservation SchurBundle::linearised(const BundleTerm& term, const Eigen::Vector3d& point) const {
  const BundleObservation& seen = observation_of(term);
  const auto pose = static_cast<std::size_t>(seen.pose);
  const Eigen::Matrix3d& rotation = estimate_.rotations[pose];
  const Eigen::Vector3d turned = rotation * point;
  const Eigen::Vector3d point_in_camera = turned + estimate_.poses[pose].translation;
  const Reprojection reprojection = reprojection_of(seen);
  LinearObservation linear;
  linear.residual = reprojection.residual(point_in_camera);
  if (border_) {
    linear.by_calibration = border_->jacobian(seen, point_in_camera);
    linear.residual += linear.by_calibration * estimate_.calibration;
  }
  linear.weight = seen.weight * huber_weight(linear.residual.squaredNorm(), huber_width_);
  const Eigen::Matrix3d by_camera = reprojection.jacobian(point_in_camera);
  linear.by_point = by_camera * rotation;
  if (term.slot >= 0) linear.by_pose << -by_camera * skew(turned), by_camera;
  return linear;
}

void SchurBundle::linearise_track(std::size_t index) {
  const BundleTrack& track = tracks_[index];
  const Eigen::Vector3d& point = estimate_.points[static_cast<std::size_t>(track.point)];
  PointEquations equations;
  between_.resize(track.end - track.begin);
  if (border_) border_->begin_point();
  for (std::size_t i = track.begin; i < track.end; ++i) {
    const BundleTerm& term = terms_[i];
    const LinearObservation linear = linearised(term, point);
    if (track.moves) equations.add(linear);
    if (border_) {
      border_->add(linear.by_calibration, linear.weight, linear.residual);
      if (track.moves) border_->add_point(linear.weight * linear.by_point.transpose(), linear.by_calibration);
    }
    if (term.slot < 0) continue;
    const Matrix63 weighted = linear.weight * linear.by_pose.transpose();
    own_[static_cast<std::size_t>(term.slot)].noalias() += weighted * linear.by_pose;
    gradient_.segment<6>(6 * term.slot).noalias() += weighted * linear.residual;
    if (track.moves) between_[i - track.begin].noalias() = weighted * linear.by_point;
    if (border_) border_->add_pose(term.slot, weighted, linear.by_calibration);
  }
  if (!track.moves) return;
  equations.damp(radius_);
  largest_slope_ = std::max(largest_slope_, equations.gradient.cwiseAbs().maxCoeff());
  eliminate(index, equations);
  if (!kept_.empty()) kept_[index] = equations;
}

// Subtracts the elimination of a point from the equations of poses and calibration.
void SchurBundle::eliminate(std::size_t index, const PointEquations& equations) {
  const BundleTrack& track = tracks_[index];
  if (border_) border_->eliminate(equations.covariance, equations.gradient);
  for (std::size_t i = track.begin; i < track.end; ++i) {
    const int row = terms_[i].slot;
    if (row < 0) continue;
    const Matrix63 gain = between_[i - track.begin] * equations.covariance;
    eliminated_.segment<6>(6 * row).noalias() += gain * equations.gradient;
    if (border_) border_->eliminate_pose(row, gain);
    for (std::size_t j = track.begin; j < track.end; ++j) {
      const int column = terms_[j].slot;
      if (column < 0 || column > row) continue;
      reduced_->at(row, column).noalias() -= gain * between_[j - track.begin].transpose();
    }
  }
}

void SchurBundle::add_scale() {
  const Pose& pose = estimate_.poses[static_cast<std::size_t>(scale_->pose)];
  const int slot = slots_[static_cast<std::size_t>(scale_->pose)];
  const Eigen::Vector3d turned = pose.rotation * scale_->place_in_world;
  const Eigen::Vector3d place_in_camera = turned + pose.translation;
  const double residual = (place_in_camera.norm() - scale_->distance) / scale_->sigma();
  const Eigen::RowVector3d by_camera = place_in_camera.normalized().transpose() / scale_->sigma();
  Eigen::Matrix<double, 1, 6> by_pose;
  by_pose << -by_camera * skew(turned), by_camera;
  own_[static_cast<std::size_t>(slot)].noalias() += by_pose.transpose() * by_pose;
  gradient_.segment<6>(6 * slot) += residual * by_pose.transpose();
}

void SchurBundle::add_motion(const BundleMotion& motion) {
  const auto earlier = static_cast<std::size_t>(motion.earlier), later = static_cast<std::size_t>(motion.later);
  const Pose& earlier_pose = estimate_.poses[earlier];
  const Pose& later_pose = estimate_.poses[later];
  const MotionError error = motion_error(motion, earlier_pose, later_pose);
  const MotionJacobians jacobians = motion_jacobians(earlier_pose, later_pose);
  const Matrix6 by_earlier = to_rotation_translation(jacobians.by_earlier, earlier_pose);
  const Matrix6 by_later = to_rotation_translation(jacobians.by_later, later_pose);
  const Matrix6 information = error.weight * motion.information;
  const int earlier_slot = slots_[earlier], later_slot = slots_[later];
  const auto add = [&](int slot, const Matrix6& jacobian) {
    own_[static_cast<std::size_t>(slot)].noalias() += jacobian.transpose() * information * jacobian;
    gradient_.segment<6>(6 * slot).noalias() += jacobian.transpose() * information * error.residual;
  };
  if (earlier_slot >= 0) add(earlier_slot, by_earlier);
  if (later_slot >= 0) add(later_slot, by_later);
  if (earlier_slot < 0 || later_slot < 0) return;
  if (later_slot > earlier_slot) {
    reduced_->at(later_slot, earlier_slot) += by_later.transpose() * information * by_earlier;
  } else {
    reduced_->at(earlier_slot, later_slot) += by_earlier.transpose() * information * by_later;
  }
}

double SchurBundle::cost_of_motions(const BundleEstimate& estimate) const {
  double twice = 0.0;
  for (const BundleMotion* const motion : motions_) {
    twice += motion_error(*motion, estimate.poses[static_cast<std::size_t>(motion->earlier)],
                          estimate.poses[static_cast<std::size_t>(motion->later)])
                 .cost;
  }
  return twice;
}

double SchurBundle::linearise(double radius) {
  const Eigen::Index size = 6 * slot_count_;
  reduced_->set_zero();
  own_.assign(static_cast<std::size_t>(slot_count_), Matrix6::Zero());
  gradient_.setZero(size);
  eliminated_.setZero(size);
  largest_slope_ = 0.0;
  radius_ = radius;
  if (border_) border_->begin(estimate_.calibration);
  for (std::size_t i = 0; i < tracks_.size(); ++i) linearise_track(i);
  if (scale_) add_scale();
  for (const BundleMotion* const motion : motions_) add_motion(*motion);
  damping_.resize(size);
  for (int slot = 0; slot < slot_count_; ++slot) {
    const Matrix6& own = own_[static_cast<std::size_t>(slot)];
    damping_.segment<6>(6 * slot) = own.diagonal().unaryExpr(&bounded) / radius;
    auto diagonal_block = reduced_->at(slot, slot);
    diagonal_block += own;
    diagonal_block.diagonal() += damping_.segment<6>(6 * slot);
  }
  if (border_) {
    border_->damp(radius);
    largest_slope_ = std::max(largest_slope_, border_->max_abs_gradient());
  }
  return size == 0 ? largest_slope_ : std::max(largest_slope_, gradient_.cwiseAbs().maxCoeff());
}

// Steps of poses and calibration. False if the equations have no solution.
bool SchurBundle::solve_poses(BundleStep& step) {
  const Eigen::VectorXd right_side = eliminated_ - gradient_;
  if (border_) {
    std::optional<CalibrationBorder::Step> solved = border_->solve(*reduced_, right_side);
    if (!solved) return false;
    step.poses = std::move(solved->poses);
    step.calibration = solved->calibration;
    step.expected_gain = solved->expected_gain;
    step.squared_length = step.calibration.squaredNorm();
  } else {
    std::optional<Eigen::VectorXd> poses = reduced_->solve(right_side);
    if (!poses) return false;
    step.poses = std::move(*poses);
  }
  step.expected_gain += 0.5 * step.poses.dot(damping_.cwiseProduct(step.poses) - gradient_);
  step.squared_length += step.poses.squaredNorm();
  return true;
}

std::optional<BundleStep> SchurBundle::solve() {
  BundleStep step;
  if (!solve_poses(step)) return std::nullopt;
  step.points.reserve(tracks_.size());
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    if (tracks_[t].moves && !solve_point(t, step)) return std::nullopt;
  }
  return step;
}

std::vector<Matrix6> SchurBundle::covariances(const std::vector<int>& poses) {
  constexpr double kUndamped = 1e16;
  if (poses.empty()) return {};
  linearise(kUndamped);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(6 * slot_count_, 6 * static_cast<Eigen::Index>(poses.size()));
  const auto slot_of = [&](std::size_t i) { return slots_[static_cast<std::size_t>(poses[i])]; };
  for (std::size_t i = 0; i < poses.size(); ++i) columns.block<6, 6>(6 * slot_of(i), 6 * i).setIdentity();
  const auto solved = reduced_->solve_several(columns);
  if (!solved) return {};
  std::vector<Matrix6> covariances;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Matrix6 delta_from_step = Matrix6::Zero();  // steps are a rotation about the camera, then a translation
    delta_from_step.topLeftCorner<3, 3>() = skew(estimate_.poses[static_cast<std::size_t>(poses[i])].translation);
    delta_from_step.topRightCorner<3, 3>().setIdentity();
    delta_from_step.bottomLeftCorner<3, 3>().setIdentity();
    const Matrix6 of_step = solved->block<6, 6>(6 * slot_of(i), 6 * i);
    covariances.push_back(delta_from_step * of_step * delta_from_step.transpose());
  }
  return covariances;
}

// Step of a point by back-substitution. False if it has no solution.
bool SchurBundle::solve_point(std::size_t index, BundleStep& step) {
  const BundleTrack& track = tracks_[index];
  const Eigen::Vector3d& point = estimate_.points[static_cast<std::size_t>(track.point)];
  const bool is_kept = !kept_.empty();
  PointEquations equations;
  if (is_kept) equations = kept_[index];
  between_.resize(track.end - track.begin);
  if (border_) border_->begin_point();
  for (std::size_t i = track.begin; i < track.end; ++i) {
    if (is_kept && terms_[i].slot < 0 && !border_) continue;
    const LinearObservation linear = linearised(terms_[i], point);
    if (!is_kept) equations.add(linear);
    if (border_) border_->add_point(linear.weight * linear.by_point.transpose(), linear.by_calibration);
    if (terms_[i].slot < 0) continue;
    const Matrix63 weighted = linear.weight * linear.by_pose.transpose();
    between_[i - track.begin].noalias() = weighted * linear.by_point;
  }
  if (!is_kept) equations.damp(radius_);
  Eigen::Vector3d right_side = -equations.gradient;
  for (std::size_t i = track.begin; i < track.end; ++i) {
    const int slot = terms_[i].slot;
    if (slot >= 0) right_side.noalias() -= between_[i - track.begin].transpose() * step.poses.segment<6>(6 * slot);
  }
  if (border_) right_side -= border_->point_right_side(step.calibration);
  const Eigen::Vector3d move = equations.covariance * right_side;
  if (!move.allFinite()) return false;
  step.points.push_back(move);
  step.expected_gain += 0.5 * move.dot(equations.damping.cwiseProduct(move) - equations.gradient);
  step.squared_length += move.squaredNorm();
  return true;
}

BundleEstimate SchurBundle::moved(const BundleStep& step) const {
  BundleEstimate moved = estimate_;
  moved.calibration += step.calibration;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (slots_[i] < 0) continue;
    const Vector6 change = step.poses.segment<6>(6 * slots_[i]);
    Pose& pose = moved.poses[i];
    pose.rotation = (rotation_exp(change.head<3>()) * pose.rotation).normalized();
    pose.translation += change.tail<3>();
    moved.rotations[i] = pose.rotation.toRotationMatrix();
  }
  auto change = step.points.begin();
  for (const BundleTrack& track : tracks_) {
    if (track.moves) moved.points[static_cast<std::size_t>(track.point)] += *change++;
  }
  return moved;
}

double SchurBundle::cost_of(const BundleEstimate& estimate) const {
  double twice = 0.0;
  for (const BundleTrack& track : tracks_) {
    const Eigen::Vector3d& point = estimate.points[static_cast<std::size_t>(track.point)];
    for (std::size_t i = track.begin; i < track.end; ++i) {
      const BundleObservation& seen = observation_of(terms_[i]);
      const auto pose = static_cast<std::size_t>(seen.pose);
      const Eigen::Vector3d point_in_camera = estimate.rotations[pose] * point + estimate.poses[pose].translation;
      Eigen::Vector3d residual = reprojection_of(seen).residual(point_in_camera);
      if (border_) residual += border_->jacobian(seen, point_in_camera) * estimate.calibration;
      twice += seen.weight * huber_cost(residual.squaredNorm(), huber_width_);
    }
  }
  if (border_) twice += 2.0 * border_->cost(estimate.calibration);
  twice += cost_of_motions(estimate);
  if (!scale_) return 0.5 * twice;
  const Pose& pose = estimate.poses[static_cast<std::size_t>(scale_->pose)];
  const double residual = ((pose * scale_->place_in_world).norm() - scale_->distance) / scale_->sigma();
  return 0.5 * (twice + residual * residual);
}

double SchurBundle::squared_length() const {
  double squared = estimate_.calibration.squaredNorm();
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (slots_[i] >= 0) squared += 1.0 + estimate_.poses[i].translation.squaredNorm();  // a unit quaternion adds 1
  }
  for (const BundleTrack& track : tracks_) {
    if (track.moves) squared += estimate_.points[static_cast<std::size_t>(track.point)].squaredNorm();
  }
  return squared;
}

enum class Progress : std::uint8_t { goes_on, settled, failed };

// One iteration: takes a step if it reduces the cost.
Progress iterate(SchurBundle& bundle, TrustRegion& region, double& cost) {
  constexpr double kLevel = 1e-10;      // gradient
  constexpr double kStill = 1e-8;       // relative to the length of all moving parameters
  constexpr double kLeastShare = 1e-3;  // share of the expected gain
  constexpr double kLeastGain = 1e-6;   // share of the cost
  if (bundle.linearise(region.radius()) <= kLevel) return Progress::settled;
  const std::optional<BundleStep> step = bundle.solve();
  if (!step || !(step->expected_gain > 0.0)) {
    region.narrow();
    return region.is_too_small() || !std::isfinite(cost) ? Progress::failed : Progress::goes_on;
  }
  if (std::sqrt(step->squared_length) <= kStill * (std::sqrt(bundle.squared_length()) + kStill)) {
    return Progress::settled;
  }
  BundleEstimate moved = bundle.moved(*step);
  const double new_cost = bundle.cost_of(moved);
  const double gain = cost - new_cost;
  const bool is_last = std::abs(gain) <= kLeastGain * cost;
  if (gain > (is_last ? 0.0 : kLeastShare * step->expected_gain)) {
    bundle.set_estimate(std::move(moved));
    cost = new_cost;
    region.widen(gain / step->expected_gain);
  } else {
    region.narrow();
  }
  return is_last || region.is_too_small() ? Progress::settled : Progress::goes_on;
}

}  // namespace

BundleSolution solve_bundle(const BundleProblem& problem, const BundleRoles& roles,
                            const std::optional<FixedDistance>& scale, const BundleOptions& options) {
  SchurBundle bundle(problem, roles, scale, options.huber_width);
  BundleSolution solution;
  double cost = bundle.cost();
  Progress progress = std::isfinite(cost) ? Progress::goes_on : Progress::failed;
  TrustRegion region;
  while (progress == Progress::goes_on && solution.iterations < options.max_iterations) {
    if (options.should_stop && options.should_stop()) break;
    progress = iterate(bundle, region, cost);
    ++solution.iterations;
  }
  solution.usable = progress != Progress::failed;
  if (solution.usable) solution.pose_covariances = bundle.covariances(options.covariances_of_poses);
  BundleEstimate found = bundle.take_estimate();
  solution.camera_from_world = std::move(found.poses);
  solution.points_in_world = std::move(found.points);
  solution.calibration_change = found.calibration;
  return solution;
}

}  // namespace byre
