#include "byre/slam/calibration/calibration_on_map.h"

#include "byre/optimise/robust_error.h"
#include "byre/slam/calibration/determined_calibration.h"

#include <cmath>

#include <Eigen/Cholesky>

namespace byre {
namespace {

constexpr int kMinOfflinePoints = 40;  // offline points in a frame
constexpr int kMaxRows = 60;           // stereo matches of a frame whose rows are used
// Weight of a frame: errors of points and of their positions are correlated between frames.
constexpr double kIndependence = 0.1;

constexpr double kCalibrationHuberWidth = 2.0;  // sigmas
constexpr double kSystematicSigma = 0.2;        // pixels, errors that neither noise nor the calibration explains
constexpr int kMaxPoints = 120;                 // most points of a frame that are used

using ByPose = Eigen::Matrix<double, 3, 6>;
using ByCalibration = Eigen::Matrix<double, 3, kCalibrationParameters>;

// Linearised measurement of one offline point: residual and Jacobians, in sigmas.
struct CalibrationRow {
  Eigen::Vector3d residual;
  ByPose by_pose;
  ByCalibration by_calibration;
};

Eigen::Vector3d sigmas_of(const TrackedFeature& feature, const Keypoint& keypoint, const MapPoint& point,
                          const StereoJacobian& by_world) {
  const Eigen::Vector3d of_point = (by_world * point.covariance * by_world.transpose()).diagonal();
  const double systematic = kSystematicSigma * kSystematicSigma;
  const double pixel = feature.pixel_sigma * feature.pixel_sigma + systematic;
  const double disparity = keypoint.disparity_sigma * keypoint.disparity_sigma + systematic;
  return (Eigen::Vector3d(pixel, pixel, disparity) + of_point).cwiseSqrt();
}

std::optional<CalibrationRow> row_of(const TrackedFeature& feature, const Keypoint& keypoint, const MapPoint& point,
                                     const Pose& camera_from_world, const Rig& rig,
                                     const CalibrationSensitivity& sensitivity) {
  const Eigen::Vector3d point_in_camera = camera_from_world * point.position_in_world;
  if (point_in_camera.z() <= 0.0) return std::nullopt;
  const StereoJacobian by_camera = rig.projection_jacobian(point_in_camera);
  const Eigen::Vector3d sigmas =
      sigmas_of(feature, keypoint, point, by_camera * camera_from_world.rotation.toRotationMatrix());
  Eigen::Vector3d weights = sigmas.cwiseInverse();
  if (!keypoint.has_disparity()) weights.z() = 0.0;
  const StereoPixel measured(feature.pixel.x(), feature.pixel.y(), keypoint.disparity);
  StereoPixel expected = rig.project(point_in_camera);
  CalibrationRow row;
  row.residual = weights.asDiagonal() * (measured - expected);
  row.by_pose << by_camera, -by_camera * skew(point_in_camera);
  row.by_pose = weights.asDiagonal() * row.by_pose;
  if (!keypoint.has_disparity()) expected.z() = 0.0;
  row.by_calibration = weights.asDiagonal() * sensitivity.at(expected).topRows<3>();
  const double influence = std::sqrt(huber_weight(row.residual.squaredNorm(), kCalibrationHuberWidth));
  return CalibrationRow{influence * row.residual, influence * row.by_pose, influence * row.by_calibration};
}

}  // namespace

double length_sigma(const Features& features) {
  constexpr double kCommonError = 0.08;  // pixels
  double sum = 0.0, squares = 0.0;
  for (const Keypoint& keypoint : features.keypoints()) {
    if (!keypoint.has_disparity()) continue;
    const double disparity = keypoint.disparity;
    sum += disparity;
    squares += disparity * disparity;
  }
  return squares > 0.0 ? kCommonError * sum / squares : 0.0;
}

CalibrationOnMap::CalibrationOnMap(const Calibration& given, double prior_sigmas)
    : given_(given), prior_sigmas_(prior_sigmas), sensitivity_(given) {}

void CalibrationOnMap::add(const Frame& frame, const Rig& rig, const TrackedFrame& tracked, const MapView& map,
                           const CalibrationVector& change) {
  std::vector<const TrackedFeature*> offline;
  for (const TrackedFeature& feature : tracked.features) {
    if (feature.point.origin == Origin::offline) offline.push_back(&feature);
  }
  if (static_cast<int>(offline.size()) < kMinOfflinePoints) return;
  const std::size_t stride = 1 + offline.size() / kMaxPoints;
  Matrix6 pose_pose = Matrix6::Zero();
  Eigen::Matrix<double, 6, kCalibrationParameters> pose_calibration;
  pose_calibration.setZero();
  CalibrationMatrix information = CalibrationMatrix::Zero();
  CalibrationVector right_side = CalibrationVector::Zero();
  Vector6 right_side_of_pose = Vector6::Zero();
  for (std::size_t i = static_cast<std::size_t>(frames_) % stride; i < offline.size(); i += stride) {
    const MapPoint* const point = map.find_point(offline[i]->point);
    if (point == nullptr) continue;
    const auto row = row_of(*offline[i], frame.features->keypoint(offline[i]->feature), *point,
                            tracked.camera_from_world, rig, sensitivity_);
    if (!row) continue;
    const Eigen::Vector3d seen = row->residual + row->by_calibration * change;
    pose_pose.noalias() += row->by_pose.transpose() * row->by_pose;
    pose_calibration.noalias() += row->by_pose.transpose() * row->by_calibration;
    information.noalias() += row->by_calibration.transpose() * row->by_calibration;
    right_side.noalias() += row->by_calibration.transpose() * seen;
    right_side_of_pose.noalias() += row->by_pose.transpose() * seen;
    ++observations_;
  }
  const Eigen::LDLT<Matrix6> factor(pose_pose);
  if (factor.info() != Eigen::Success) return;
  const double share = kIndependence;
  const Eigen::Matrix<double, 6, kCalibrationParameters> solved_calibration = factor.solve(pose_calibration);
  const Vector6 solved_pose = factor.solve(right_side_of_pose);
  information_ += share * (information - pose_calibration.transpose() * solved_calibration);
  right_side_ += share * (right_side - pose_calibration.transpose() * solved_pose);
  add_rows(*frame.features, change);
  ++frames_;
}

void CalibrationOnMap::add_rows(const Features& features, const CalibrationVector& change) {
  const auto stride = static_cast<std::size_t>(1 + features.size() / kMaxRows);
  for (std::size_t i = static_cast<std::size_t>(frames_) % stride; i < features.keypoints().size(); i += stride) {
    const Keypoint& keypoint = features.keypoints()[i];
    if (!keypoint.has_disparity()) continue;
    const Eigen::Matrix<double, 1, kCalibrationParameters> row =
        sensitivity_.at({keypoint.pixel.x(), keypoint.pixel.y(), keypoint.disparity}).row(3);
    const double sigma = std::hypot(static_cast<double>(keypoint.disparity_sigma), kSystematicSigma);
    const double residual = keypoint.row_offset / sigma;
    const double weight = kIndependence * huber_weight(residual * residual, kCalibrationHuberWidth) / (sigma * sigma);
    information_.noalias() += weight * row.transpose() * row;
    right_side_ += weight * (keypoint.row_offset + row.dot(change)) * row.transpose();
  }
}

CalibrationMatrix CalibrationOnMap::posterior() const {
  return information_ + CalibrationMatrix::Identity() / (prior_sigmas_ * prior_sigmas_);
}

double CalibrationOnMap::length_sigma(const Features& features, const CalibrationVector& change) const {
  Eigen::Matrix<double, 1, kCalibrationParameters> by_calibration;
  by_calibration.setZero();
  double squares = 0.0;
  for (const Keypoint& keypoint : features.keypoints()) {
    if (!keypoint.has_disparity()) continue;
    const StereoPixel pixel(keypoint.pixel.x(), keypoint.pixel.y(), keypoint.disparity);
    by_calibration += pixel.z() * sensitivity_.at(pixel).row(2);
    squares += pixel.z() * pixel.z();
  }
  if (!(squares > 0.0)) return 0.0;
  by_calibration /= squares;
  const Eigen::LDLT<CalibrationMatrix> factor(posterior());
  const double variance = by_calibration * factor.solve(by_calibration.transpose());
  const double open = by_calibration * (factor.solve(right_side_) - change);
  return std::hypot(byre::length_sigma(features), std::sqrt(variance), open);
}

RefinedCalibration CalibrationOnMap::estimate() const {
  const CalibrationMatrix posterior = this->posterior();
  const CalibrationVector expected = posterior.ldlt().solve(right_side_);
  const CalibrationVector prior_sigmas = calibrated_sigmas(prior_sigmas_);
  RefinedCalibration result = determined_calibration(given_, posterior, expected, prior_sigmas);
  reject_implausible(result, expected, given_, prior_sigmas);
  result.keyframes = frames_;
  result.observations = observations_;
  return result;
}

}  // namespace byre
