// Part of pose_filter.h: covariances of poses.

#include "byre/slam/localisation/mission.h"
#include "byre/slam/localisation/pose_filter.h"
#include "byre/slam/tracking/body_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace byre {

Matrix6 PoseFilter::carried_covariance() const {
  if (!carried_) return Matrix6::Zero();
  return move_covariance(carried_->covariance, inverse(odometry_.map_from_body()) * carried_->map_from_body);
}

Matrix6 PoseFilter::bridged_odometry_covariance() const {
  if (!odometry_open_) return Matrix6::Zero();
  return move_covariance(odometry_open_->covariance,
                         inverse(odometry_.odometry_from_body()) * odometry_open_->map_from_body);
}

Matrix6 PoseFilter::jump_covariance() const {
  Matrix6 covariance = Matrix6::Zero();
  covariance.topLeftCorner<3, 3>().diagonal().setConstant(
      std::max({jump_variance_, disagreement_variance_, contradiction_variance_}) / 3.0);
  return covariance;
}

// Two errors since then: along the way, because all lengths err by the same share, and in all directions.
Matrix6 PoseFilter::drift_covariance(double length_sigma) const {
  Matrix6 covariance = Matrix6::Zero();
  if (!held_) return covariance;
  const Eigen::Vector3d error =
      length_sigma * (inverse(odometry_.map_from_body()) * held_->map_from_body).translation;  // in the body
  covariance.topLeftCorner<3, 3>() = error * error.transpose();
  constexpr double kShare = 0.003;  // share of the path
  const double path = kShare * (odometry_.travelled() - held_->travelled);
  covariance.topLeftCorner<3, 3>().diagonal().array() += (held_->sigma * held_->sigma + path * path) / 3.0;
  return covariance;
}

double PoseFilter::drift_sigma(double length_sigma) const {
  if (!held_) return std::numeric_limits<double>::infinity();
  return std::sqrt(position_variance(drift_covariance(length_sigma)));
}

void PoseFilter::note_held(double sigma, double length_sigma) {
  if (sigma < drift_sigma(length_sigma)) held_ = Held{odometry_.map_from_body(), sigma, odometry_.travelled()};
}

// Compares a tracked pose with its prediction by measured motion and by velocity; the closer one counts, because wheels
// slip and velocities change. Precondition: the pose is not in the trajectory yet.
void PoseFilter::note_jump(const TrackedPose& seen, const Pose& body, const Rig& rig, const MapView& map) {
  constexpr double kSigmas = 4.0;
  constexpr double kAcceleration = 5.0;  // m/s^2, one sigma
  constexpr double kDecay = 1.0;         // seconds
  if (!has_pose_ || trajectory_.empty()) return void(jump_variance_ = 0.0);
  const double seconds = to_seconds(seen.frame.time - trajectory_.back().time);
  const double before = std::exchange(jump_variance_, jump_variance_ * std::exp(-seconds / kDecay));
  if (seen.is_relocalised || !place_.is_confirmed()) return;
  const Pose last = byre::camera_from_world(map, trajectory_.back());
  const Matrix6 now = move_covariance(seen.track.tracked.covariance, rig.body_from_camera);
  const double known = std::max(0.0, position_variance(quality_.covariance) - before) + position_variance(now) +
                       seen.drift_sigma * seen.drift_sigma;
  const auto unexplained = [&](const Pose& predicted, double variance) {
    return (predicted.translation - body.translation).squaredNorm() - kSigmas * kSigmas * (known + variance);
  };
  std::optional<double> jump;
  if (const auto predicted = motion_.predict_by_velocity(last, seconds)) {
    jump = unexplained(body_pose(rig, *predicted), std::pow(kAcceleration * seconds * seconds, 2));
  }
  if (const auto& measured = motion_.measured()) {
    const Pose predicted = body_pose(rig, last) * measured->last_from_body;
    const double by_measured = unexplained(predicted, position_variance(measured->covariance));
    jump = std::min(jump.value_or(by_measured), by_measured);
  }
  if (jump) jump_variance_ = std::max(jump_variance_, *jump);
}

// Whichever pose is right, one is wrong by the distance. If the offline one prevails, drift may explain it. If the
// online one is taken, the disagreement stays open until many offline points agree with the pose again: beyond the
// offline map nothing shows which of them was right.
void PoseFilter::note_disagreement(const HybridTrack& track) {
  constexpr double kSigmas = 4.0;
  contradiction_variance_ = 0.0;
  if (!track.maps_disagree && track.offline_inliers >= kOfflineThatHolds) disagreement_variance_ = 0.0;
  if (!track.maps_disagree || !track.from_offline || !track.from_online) return;
  const double distance = agreement_of(*track.from_offline, *track.from_online).translation;
  if (!track.offline_prevails) {
    disagreement_variance_ = std::max(disagreement_variance_, distance * distance);
  } else if (distance > kSigmas * std::hypot(track.online_sigma, track.offline_sigma)) {
    contradiction_variance_ = distance * distance;
  }
}

// Adds the covariance of a measured motion that ends at a found place, which the odometry follows.
void PoseFilter::add_odometry_covariance(const std::optional<BodyMotion>& odometry_motion) {
  if (!odometry_motion) return;
  const Matrix6 covariance = bridged_odometry_covariance() + odometry_motion->covariance;
  odometry_open_ = {odometry_.odometry_from_body(), covariance};
}

// Precondition: there is a bridge.
Matrix6 PoseFilter::covariance_of_bridge() const {
  if (bridge_covariance_) return *bridge_covariance_;
  return move_covariance(quality_.covariance, inverse(bridge_->last_from_body)) + bridge_->covariance;
}

}  // namespace byre
