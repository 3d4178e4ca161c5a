#include "byre/optimise/calibration_covariance.h"

#include "byre/optimise/bundle_covariance.h"
#include "byre/optimise/reprojection.h"

#include <cassert>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>

namespace byre {
namespace {

using Row = Eigen::Matrix<double, 3, 6>;
using CalibrationRow = Eigen::Matrix<double, 3, kCalibrationParameters>;

// Weighted derivatives of one observation.
struct Share {
  int slot = -1;  // index of the pose in the reduced matrix, negative for a fixed pose
  Row by_pose;
  Eigen::Matrix3d by_point;
  CalibrationRow by_calibration;
};

Share weighted_share(const BundleProblem& solved, const BundleObservation& observation, double huber_width) {
  const auto [weight, by_pose, by_point] = weighted_derivatives(solved, observation, huber_width);
  Share share{-1, by_pose, by_point, CalibrationRow::Zero()};
  if (solved.calibration->rig != solved.poses[observation.pose].rig) return share;
  const Eigen::Vector3d per_pixel(weight / observation.pixel_sigma, weight / observation.pixel_sigma,
                                  observation.is_stereo() ? weight / observation.disparity_sigma : 0.0);
  share.by_calibration =
      per_pixel.asDiagonal() * solved.calibration->sensitivity->at(observation.measured).topRows<3>();
  return share;
}

// Normal matrix over moving poses, then the calibration; lower triangle.
class CalibrationSystem {
 public:
  explicit CalibrationSystem(int poses)
      : poses_(6 * poses),
        matrix_(Eigen::MatrixXd::Zero(poses_ + kCalibrationParameters, poses_ + kCalibrationParameters)) {}

  // Adds all observations of one point and eliminates it unless it is fixed. Skips an undetermined point.
  void add(const std::vector<Share>& shares, bool is_fixed) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    for (const Share& share : shares) information += share.by_point.transpose() * share.by_point;
    information.diagonal().array() += kFreePoint * information.trace();
    const Eigen::LLT<Eigen::Matrix3d> factor(information);
    if (!is_fixed && !is_regular(factor, information)) return;
    add_known(shares);
    if (!is_fixed) eliminate(shares, factor.solve(Eigen::Matrix3d::Identity()));
  }

  // Information of the calibration with the poses eliminated. To be called once: it overwrites the matrix.
  std::optional<CalibrationMatrix> of_calibration() {
    const CalibrationMatrix own = matrix_.bottomRightCorner<kCalibrationParameters, kCalibrationParameters>();
    const CalibrationMatrix whole = own.selfadjointView<Eigen::Lower>();
    if (poses_ == 0) return whole;
    auto of_poses = matrix_.topLeftCorner(poses_, poses_);
    of_poses.diagonal().array() += kFreePose;
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(of_poses);
    if (factor.info() != Eigen::Success) return std::nullopt;
    const Eigen::MatrixXd rows =
        factor.matrixL().solve(matrix_.bottomLeftCorner(kCalibrationParameters, poses_).transpose());
    return CalibrationMatrix(whole - rows.transpose() * rows);
  }

 private:
  // Information added to each pose, 1 / m^2 and 1 / rad^2, which bounds undetermined directions such as the gauge.
  static constexpr double kFreePose = 1e-2;
  // Information added to each point, relative to its own: rounding errors of a nearly undetermined depth may exceed its
  // information.
  static constexpr double kFreePoint = 1e-8;

  void add_known(const std::vector<Share>& shares) {
    for (const Share& share : shares) {
      of_calibration_pair().noalias() += share.by_calibration.transpose() * share.by_calibration;
      if (share.slot < 0) continue;
      matrix_.block<6, 6>(6 * share.slot, 6 * share.slot).noalias() += share.by_pose.transpose() * share.by_pose;
      of_calibration_and(share.slot).noalias() += share.by_calibration.transpose() * share.by_pose;
    }
  }

  void eliminate(const std::vector<Share>& shares, const Eigen::Matrix3d& covariance) {
    Eigen::Matrix<double, kCalibrationParameters, 3> calibration_point;
    calibration_point.setZero();
    for (const Share& share : shares) calibration_point += share.by_calibration.transpose() * share.by_point;
    const Eigen::Matrix<double, kCalibrationParameters, 3> gain = calibration_point * covariance;
    of_calibration_pair().noalias() -= gain * calibration_point.transpose();
    for (const Share& row : shares) {
      if (row.slot < 0) continue;
      const Eigen::Matrix<double, 6, 3> pose_point = row.by_pose.transpose() * row.by_point;
      of_calibration_and(row.slot).noalias() -= gain * pose_point.transpose();
      for (const Share& column : shares) {
        if (column.slot < 0 || column.slot > row.slot) continue;
        matrix_.block<6, 6>(6 * row.slot, 6 * column.slot).noalias() -=
            pose_point * covariance * (column.by_point.transpose() * column.by_pose);
      }
    }
  }

  Eigen::Block<Eigen::MatrixXd, kCalibrationParameters, kCalibrationParameters> of_calibration_pair() {
    return matrix_.bottomRightCorner<kCalibrationParameters, kCalibrationParameters>();
  }
  Eigen::Block<Eigen::MatrixXd, kCalibrationParameters, 6> of_calibration_and(int slot) {
    return matrix_.block<kCalibrationParameters, 6>(poses_, 6 * slot);
  }

  int poses_;  // rows
  Eigen::MatrixXd matrix_;
};

// Index of each moving, observed pose in the reduced matrix; negative for the others.
std::vector<int> slots_of_moving_poses(const BundleProblem& solved, const std::vector<int>& observations, int& count) {
  std::vector<int> slots(solved.poses.size(), -1);
  for (const int i : observations) slots[solved.observations[static_cast<std::size_t>(i)].pose] = 0;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    if (solved.poses[i].fixed) slots[i] = -1;
    if (slots[i] == 0) slots[i] = count++;
  }
  return slots;
}

}  // namespace

std::optional<CalibrationMatrix> calibration_information(const BundleProblem& solved, double huber_width) {
  assert(solved.calibration);
  const std::vector<int> observations = observations_by_point(solved);
  int pose_count = 0;
  const std::vector<int> slots = slots_of_moving_poses(solved, observations, pose_count);
  CalibrationSystem reduced(pose_count);
  std::vector<Share> shares;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const BundleObservation& observation = solved.observations[static_cast<std::size_t>(observations[i])];
    shares.push_back(weighted_share(solved, observation, huber_width));
    shares.back().slot = slots[observation.pose];
    const bool is_last_of_point =
        i + 1 == observations.size() ||
        solved.observations[static_cast<std::size_t>(observations[i + 1])].point != observation.point;
    if (!is_last_of_point) continue;
    reduced.add(shares, solved.points[observation.point].fixed);
    shares.clear();
  }
  const auto of_observations = reduced.of_calibration();
  if (!of_observations) return std::nullopt;
  return CalibrationMatrix(*of_observations + solved.calibration->information);
}

}  // namespace byre
