#include "byre/optimise/bundle_covariance.h"

#include "byre/geometry/image_regions.h"
#include "byre/optimise/bundle_motion.h"
#include "byre/optimise/reprojection.h"
#include "byre/optimise/robust_error.h"

#include <cassert>
#include <cmath>
#include <numeric>
#include <vector>

namespace byre {

namespace {

using Matrix63 = Eigen::Matrix<double, 6, 3>;

// Contribution of one observation to the normal equations.
struct Block {
  int slot = -1;  // index of the pose in the reduced matrix, negative for a fixed pose
  Matrix6 pose_pose;
  Matrix63 pose_point;
  Eigen::Matrix3d point_point;
};

Block weighted_block(const BundleProblem& solved, const BundleObservation& observation, double huber_width) {
  const auto [weight, by_pose, by_point] = weighted_derivatives(solved, observation, huber_width);
  return {-1, by_pose.transpose() * by_pose, by_pose.transpose() * by_point, by_point.transpose() * by_point};
}

bool in_front(const BundleProblem& solved, const BundleObservation& observation) {
  const Pose& camera_from_world = solved.poses[observation.pose].camera_from_world;
  return (camera_from_world * solved.points[observation.point].position_in_world).z() >= kNearestDepth;
}

// Index of each moving, observed pose in the reduced matrix, else -1. The wanted pose is last, for last_marginal().
std::vector<int> pose_slots(const BundleProblem& solved, const std::vector<int>& observations, int wanted) {
  std::vector<int> slots(solved.poses.size(), -1);
  for (const int i : observations) slots[solved.observations[i].pose] = 0;
  int count = 0;
  for (int i = 0; i < static_cast<int>(slots.size()); ++i) {
    if (solved.poses[i].fixed) slots[i] = -1;
    if (slots[i] == 0 && i != wanted) slots[i] = count++;
  }
  if (slots[wanted] == 0) slots[wanted] = count;
  return slots;
}

// Empty if the point is not determined, such as one observed once without a disparity.
std::optional<Eigen::Matrix3d> point_covariance(const std::vector<Block>& blocks) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const Block& block : blocks) information += block.point_point;
  const Eigen::LLT<Eigen::Matrix3d> factor(information);
  if (!is_regular(factor, information)) return std::nullopt;
  return factor.solve(Eigen::Matrix3d::Identity());
}

// Normal matrix over the poses, lower triangle.
class ReducedMatrix {
 public:
  explicit ReducedMatrix(int poses) : matrix_(Eigen::MatrixXd::Zero(6 * poses, 6 * poses)) {}

  // Adds all observations of one point as if its position were exact.
  void add(const std::vector<Block>& blocks) {
    for (const Block& block : blocks) {
      if (block.slot >= 0) at(block.slot, block.slot) += block.pose_pose;
    }
  }

  void add(int slot, const Matrix6& information) { at(slot, slot) += information; }

  // Adds the block between two poses to the lower triangle.
  void add(int row, int column, const Matrix6& information) {
    if (column <= row) {
      at(row, column) += information;
    } else {
      at(column, row) += information.transpose();
    }
  }

  // Subtracts the information used to estimate the point's position.
  void eliminate(const std::vector<Block>& blocks, const Eigen::Matrix3d& point_covariance) {
    for (const Block& row : blocks) {
      if (row.slot < 0) continue;
      const Matrix63 gain = row.pose_point * point_covariance;
      for (const Block& column : blocks) {
        if (column.slot < 0 || column.slot > row.slot) continue;
        at(row.slot, column.slot).noalias() -= gain * column.pose_point.transpose();
      }
    }
  }

  const Eigen::MatrixXd& lower_triangle() const { return matrix_; }

 private:
  Eigen::Block<Eigen::MatrixXd, 6, 6> at(int row, int column) { return matrix_.block<6, 6>(6 * row, 6 * column); }

  Eigen::MatrixXd matrix_;
};

// Skips an undetermined point: it constrains the poses very little, and the covariance errs on the large side.
void add_point(ReducedMatrix& reduced, const std::vector<Block>& blocks, bool fixed) {
  if (fixed) return reduced.add(blocks);
  const auto covariance = point_covariance(blocks);
  if (!covariance) return;
  reduced.add(blocks);
  reduced.eliminate(blocks, *covariance);
}

// Information on the pose from the held distance.
Matrix6 scale_information(const FixedDistance& scale, const Pose& camera_from_world) {
  const Eigen::Vector3d place_in_camera = camera_from_world * scale.place_in_world;
  const Eigen::RowVector3d by_camera = place_in_camera.normalized().transpose() / scale.sigma();
  Eigen::Matrix<double, 1, 6> by_pose;
  by_pose << by_camera, -by_camera * skew(place_in_camera);
  return by_pose.transpose() * by_pose;
}

void add_motions(ReducedMatrix& reduced, const BundleProblem& solved, const std::vector<int>& slots) {
  for (const BundleMotion& motion : solved.motions) {
    const Pose& earlier = solved.poses[motion.earlier].camera_from_world;
    const Pose& later = solved.poses[motion.later].camera_from_world;
    const Matrix6 information = motion_error(motion, earlier, later).weight * motion.information;
    const auto [by_earlier, by_later] = motion_jacobians(earlier, later);
    const int first = slots[motion.earlier], second = slots[motion.later];
    if (first >= 0) reduced.add(first, by_earlier.transpose() * information * by_earlier);
    if (second >= 0) reduced.add(second, by_later.transpose() * information * by_later);
    if (first >= 0 && second >= 0) reduced.add(second, first, by_later.transpose() * information * by_earlier);
  }
}

ReducedMatrix reduce_to_poses(const BundleProblem& solved, const std::vector<int>& observations,
                              const std::vector<int>& slots, int slot_count, double huber_width) {
  ReducedMatrix reduced(slot_count);
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const BundleObservation& observation = solved.observations[observations[i]];
    blocks.push_back(weighted_block(solved, observation, huber_width));
    blocks.back().slot = slots[observation.pose];
    const bool last_of_point =
        i + 1 == observations.size() || solved.observations[observations[i + 1]].point != observation.point;
    if (!last_of_point) continue;
    add_point(reduced, blocks, solved.points[observation.point].fixed);
    blocks.clear();
  }
  return reduced;
}

// Covariance of the last pose, marginalised over the others.
std::optional<Matrix6> last_marginal(const Eigen::MatrixXd& lower_triangle) {
  const Eigen::LLT<Eigen::MatrixXd> factor(lower_triangle);
  if (!is_regular(factor, lower_triangle)) return std::nullopt;
  const Matrix6 square_root = factor.matrixL().toDenseMatrix().bottomRightCorner<6, 6>();
  const Matrix6 inverse = square_root.triangularView<Eigen::Lower>().solve(Matrix6::Identity());
  return inverse.transpose() * inverse;
}

}  // namespace

WeightedDerivatives weighted_derivatives(const BundleProblem& solved, const BundleObservation& observation,
                                         double huber_width) {
  const BundlePose& pose = solved.poses[observation.pose];
  const Eigen::Vector3d point_in_camera = pose.camera_from_world * solved.points[observation.point].position_in_world;
  const Reprojection reprojection(solved.rigs[pose.rig], observation.measured, observation.pixel_sigma,
                                  observation.disparity_sigma);
  WeightedDerivatives derivatives;
  derivatives.weight = std::sqrt(huber_weight(reprojection.residual(point_in_camera).squaredNorm(), huber_width));
  const Eigen::Matrix3d by_camera = derivatives.weight * reprojection.jacobian(point_in_camera);
  derivatives.by_pose << by_camera, -by_camera * skew(point_in_camera);
  derivatives.by_point = by_camera * pose.camera_from_world.rotation.toRotationMatrix();
  return derivatives;
}

BundleProblem with_shared_errors(BundleProblem problem, double systematic_sigma) {
  std::vector<ByImageRegion<int>> counts(problem.poses.size());
  const auto count_of = [&](const BundleObservation& observation) -> int& {
    const Rig& rig = problem.rigs[problem.poses[observation.pose].rig];
    return counts[observation.pose][image_region_of(observation.measured.x(), observation.measured.y(), rig)];
  };
  for (const BundleObservation& observation : problem.observations) ++count_of(observation);
  for (BundleObservation& observation : problem.observations) {
    const double shared = std::sqrt(count_of(observation)) * systematic_sigma;
    observation.pixel_sigma = std::hypot(observation.pixel_sigma, shared);
    if (observation.is_stereo()) observation.disparity_sigma = std::hypot(observation.disparity_sigma, shared);
  }
  return problem;
}

std::vector<int> observations_by_point(const BundleProblem& solved) {
  std::vector<int> start(solved.points.size() + 1, 0);
  for (const BundleObservation& observation : solved.observations) {
    start[observation.point + 1] += in_front(solved, observation);
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<int> indices(start.back());
  for (int i = 0; i < static_cast<int>(solved.observations.size()); ++i) {
    const BundleObservation& observation = solved.observations[i];
    if (in_front(solved, observation)) indices[start[observation.point]++] = i;
  }
  return indices;
}

std::optional<Matrix6> marginal_covariance(const BundleProblem& solved, const std::optional<FixedDistance>& scale,
                                           int pose, double huber_width) {
  assert(pose >= 0 && pose < static_cast<int>(solved.poses.size()));
  const std::vector<int> observations = observations_by_point(solved);
  const std::vector<int> slots = pose_slots(solved, observations, pose);
  if (slots[pose] < 0) return std::nullopt;
  ReducedMatrix reduced = reduce_to_poses(solved, observations, slots, slots[pose] + 1, huber_width);
  if (scale && slots[scale->pose] >= 0) {
    reduced.add(slots[scale->pose], scale_information(*scale, solved.poses[scale->pose].camera_from_world));
  }
  add_motions(reduced, solved, slots);
  return last_marginal(reduced.lower_triangle());
}

}  // namespace byre
