#pragma once

#include "byre/body_motion.h"
#include "byre/rig.h"

#include <optional>

namespace byre {

// Predicts the camera's motion until a frame's pose is estimated: by the measured motion of the body since the last
// pose, else by constant velocity, else by standstill.
class MotionModel {
 public:
  // Begins a frame. motion: of the body since the last frame; empty: unknown.
  void add_odometry(const std::optional<BodyMotion>& motion);
  // Sets a pose. velocity: of the camera, per second.
  void set_velocity(const Vector6& velocity);
  // Loses the pose; measured motion still predicts from the last one.
  void mark_lost() { velocity_.reset(); }
  // The last poses were wrong: predicts from an earlier one by the measured motion since.
  void restore_measured(const std::optional<BodyMotion>& measured) { measured_ = measured; }
  // Dead reckoning: the last pose was predicted by measured motion.
  void reset_measured() { measured_ = no_motion(); }

  // The camera is turned from here on.
  void rotate_camera(const Pose& after_from_before);
  // Lengths change by a factor from here on.
  void scale_lengths(double change);

  // Measured motion of the body since the last pose; empty if unknown, or after a gap.
  const std::optional<BodyMotion>& measured() const { return measured_; }
  // Velocity of the camera, per second: exp_pose(velocity * dt) * camera_from_world. Zero if unknown.
  Vector6 velocity() const { return velocity_.value_or(Vector6::Zero()); }

  // Camera_from_world at a time after the last pose, by measured motion. If that is unknown, or may be off by its whole
  // length, by the velocity.
  Pose predict(const Pose& last_camera_from_world, const Rig& rig, double seconds) const;
  // Prediction by the velocity alone; empty while it is unknown.
  std::optional<Pose> predict_by_velocity(const Pose& last_camera_from_world, double seconds) const;

 private:
  std::optional<Vector6> velocity_;
  std::optional<BodyMotion> measured_ = no_motion();  // since the last pose
};

}  // namespace byre
