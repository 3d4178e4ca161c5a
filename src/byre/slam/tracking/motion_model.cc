#include "byre/slam/tracking/motion_model.h"

#include "byre/alignment.h"
#include "byre/slam/tracking/body_pose.h"

#include <algorithm>
#include <cmath>

namespace byre {
namespace {

// Whether the translation may be off by its whole length, for example with spinning wheels or after a jump of their
// pose.
bool is_translation_unknown(const BodyMotion& motion) {
  constexpr double kShare = 0.9;  // share of the length
  constexpr double kLeast = 0.1;  // metres
  const double sigma = std::sqrt(position_variance(motion.covariance));
  return sigma > std::max(kLeast, kShare * motion.last_from_body.translation.norm());
}

}  // namespace

void MotionModel::add_odometry(const std::optional<BodyMotion>& motion) {
  measured_ = measured_ && motion ? std::optional(*measured_ * *motion) : std::nullopt;
}

void MotionModel::set_velocity(const Vector6& velocity) {
  velocity_ = velocity;
  measured_ = no_motion();
}

void MotionModel::rotate_camera(const Pose& after_from_before) {
  if (velocity_) velocity_ = adjoint(after_from_before) * *velocity_;
}

void MotionModel::scale_lengths(double change) {
  if (velocity_) velocity_->head<3>() *= change;
  if (measured_)
    measured_ = BodyMotion{byre::scale_lengths(measured_->last_from_body, change),
                           byre::scale_lengths(measured_->covariance, change)};
}

std::optional<Pose> MotionModel::predict_by_velocity(const Pose& last_camera_from_world, double seconds) const {
  if (!velocity_) return {};
  return exp_pose(*velocity_ * seconds) * last_camera_from_world;
}

Pose MotionModel::predict(const Pose& last_camera_from_world, const Rig& rig, double seconds) const {
  if (measured_ && velocity_ && is_translation_unknown(*measured_))
    return *predict_by_velocity(last_camera_from_world, seconds);
  if (measured_) return camera_pose(rig, body_pose(rig, last_camera_from_world) * measured_->last_from_body);
  return predict_by_velocity(last_camera_from_world, seconds).value_or(last_camera_from_world);
}

}  // namespace byre
