#include "byre/slam/calibration/readout_estimate.h"

#include "byre/optimise/robust_error.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace byre {
namespace {

constexpr int kFramesOfBlock = 8;  // frames with correlated errors
constexpr int kMinBlocks = 4;      // blocks needed
// Least first change: seconds, and sigmas of its effect on measurements. A calibration error looks like a smaller
// change in straight motion and in the first seconds.
constexpr double kMinFirst = 0.006;
constexpr double kMinEffect = 0.2;
constexpr double kMinFurther = 0.001;      // seconds, change after the first
constexpr double kMinReadoutSigmas = 5.0;  // sigmas of a change
constexpr double kLeastReadout = 0.002;    // seconds; shorter times count as zero
constexpr double kMaxReadout = 0.1;        // seconds, longest readout time

constexpr double kReadoutHuberWidth = 2.0;  // sigmas
constexpr double kUnexplainedSigma = 0.2;   // pixels, errors that neither noise nor the shutter explains

using ReadoutRow = Eigen::Matrix<double, 2, 3>;

// Linearised measurement of one point, pixels: residual and Jacobians.
struct Answer {
  Eigen::Vector2d residual;
  Eigen::Matrix<double, 2, 6> by_pose;
  Eigen::Vector2d by_readout;
  Eigen::Matrix2d weight;
};

// Precondition: the point is in front of the camera.
Answer answer_of(const TrackedFeature& feature, double row_time, const MapPoint& point, const Pose& camera_from_world,
                 const Rig& rig, const Vector6& velocity) {
  const Eigen::Vector3d point_in_camera = camera_from_world * point.position_in_world;
  const ReadoutRow by_camera = rig.projection_jacobian(point_in_camera).topRows<2>();
  const ReadoutRow by_world = by_camera * camera_from_world.rotation.toRotationMatrix();
  Eigen::Matrix2d covariance = by_world * point.covariance * by_world.transpose();
  covariance.diagonal().array() += feature.pixel_sigma * feature.pixel_sigma + kUnexplainedSigma * kUnexplainedSigma;
  Answer answer;
  answer.residual = feature.pixel.cast<double>() - rig.project(point_in_camera).head<2>();
  answer.by_pose << by_camera, -by_camera * skew(point_in_camera);
  answer.by_readout = row_time * answer.by_pose * velocity;
  const Eigen::Matrix2d information = covariance.inverse();
  answer.weight = huber_weight(answer.residual.dot(information * answer.residual), kReadoutHuberWidth) * information;
  return answer;
}

// Normal equations of a frame's pose and of the readout time.
class FrameEquations {
 public:
  void add(const Answer& answer) {
    pose_pose_.noalias() += answer.by_pose.transpose() * answer.weight * answer.by_pose;
    pose_readout_.noalias() += answer.by_pose.transpose() * answer.weight * answer.by_readout;
    pose_residual_.noalias() += answer.by_pose.transpose() * answer.weight * answer.residual;
    readout_.information += answer.by_readout.dot(answer.weight * answer.by_readout);
    readout_.right_side += answer.by_readout.dot(answer.weight * answer.residual);
    ++readout_.points;
  }

  // Empty if the points do not determine the pose.
  ReadoutEvidence without_pose() const {
    const Eigen::LDLT<Matrix6> factor(pose_pose_);
    if (factor.info() != Eigen::Success || !factor.isPositive()) return {};
    const Vector6 pose_by_readout = factor.solve(pose_readout_);
    const ReadoutEvidence left{readout_.information - pose_readout_.dot(pose_by_readout),
                               readout_.right_side - pose_residual_.dot(pose_by_readout), readout_.points};
    return left.information > 0.0 && std::isfinite(left.right_side) ? left : ReadoutEvidence{};
  }

 private:
  Matrix6 pose_pose_ = Matrix6::Zero();
  Vector6 pose_readout_ = Vector6::Zero();
  Vector6 pose_residual_ = Vector6::Zero();
  ReadoutEvidence readout_;
};

}  // namespace

ReadoutEvidence& ReadoutEvidence::operator+=(const ReadoutEvidence& other) {
  information += other.information;
  right_side += other.right_side;
  points += other.points;
  return *this;
}

ReadoutEvidence readout_evidence(const Frame& frame, const Rig& rig, const TrackedFrame& tracked, const MapView& map,
                                 const Vector6& velocity) {
  constexpr double kMinTurn = 0.3;  // radians per second; in straight motion errors look the same in each frame
  if (velocity.tail<3>().norm() < kMinTurn) return {};
  FrameEquations equations;
  for (const ScratchVector<TrackedFeature>* const features : {&tracked.features, &tracked.outliers}) {
    for (const TrackedFeature& feature : *features) {
      const MapPoint* const point = map.find_point(feature.point);
      if (point == nullptr || (tracked.camera_from_world * point->position_in_world).z() <= 0.0) continue;
      const double row_time = frame.features->keypoint(feature.feature).row_time;
      equations.add(answer_of(feature, row_time, *point, tracked.camera_from_world, rig, velocity));
    }
  }
  return equations.without_pose();
}

void ReadoutEstimator::Blocks::add(const ReadoutEvidence& block) {
  ++count;
  sum += block;
  right_side_squared += block.right_side * block.right_side;
  information_squared += block.information * block.information;
  product += block.right_side * block.information;
}

// At least the sigma by noise alone.
double ReadoutEstimator::Blocks::sigma() const {
  const double scatter = right_side_squared - 2.0 * change() * product + change() * change() * information_squared;
  return std::sqrt(std::max(scatter, sum.information)) / sum.information;
}

double ReadoutEstimator::Blocks::effect() const {
  return std::abs(change()) * std::sqrt(sum.information / std::max(1, sum.points));
}

bool ReadoutEstimator::is_significant() const {
  if (blocks_.count < kMinBlocks || blocks_.sum.information <= 0.0) return false;
  const double size = std::abs(blocks_.change());
  const bool is_first = readout_time_ == 0.0;
  return size > (is_first ? kMinFirst : kMinFurther) && (!is_first || blocks_.effect() > kMinEffect) &&
         size > kMinReadoutSigmas * blocks_.sigma() && std::abs(readout_time_ + blocks_.change()) <= kMaxReadout;
}

void ReadoutEstimator::note(const ReadoutEvidence& evidence) {
  if (evidence.information <= 0.0) return;
  block_ += evidence;
  if (++frames_in_block_ < kFramesOfBlock) return;
  blocks_.add(block_);
  block_ = {};
  frames_in_block_ = 0;
  if (!is_significant()) return;
  const double changed = readout_time_ + blocks_.change();
  readout_time_ = std::abs(changed) < kLeastReadout ? 0.0 : changed;
  blocks_ = {};
}

}  // namespace byre
