#pragma once

#include "byre/body_motion.h"
#include "byre/rig.h"

#include <optional>

namespace byre {

// How the camera is taken to move until a frame's pose is known: as the body was told to have moved since the last
// pose, else on as it moved before, else not at all.
class MotionModel {
 public:
  // A frame later; motion is that of the body since the last frame, where it is known.
  void tell(const std::optional<BodyMotion>& motion);
  // The pose is known now; velocity is that of the camera, per second.
  void reach(const Vector6& velocity);
  // The pose is not known any more; what is told leads on from the last one.
  void lose() { velocity_.reset(); }
  // The last pose was none: what is told leads on from another one, where the motion since that is known.
  void go_back_to(const std::optional<BodyMotion>& told) { told_ = told; }
  // The last pose is where what was told has led.
  void go_on() { told_ = no_motion(); }

  // From here on the camera is one that is turned against the one before.
  void turn_camera(const Pose& after_from_before);
  // From here on lengths are so many times what they were.
  void scale_lengths(double change);

  // The body's motion since the last pose, where it is known without a gap.
  const std::optional<BodyMotion>& told() const { return told_; }
  // The camera's, per second: exp_pose(velocity * dt) * camera_from_world. Zero where it is not known.
  Vector6 velocity() const { return velocity_.value_or(Vector6::Zero()); }

  // camera_from_world at a time after the last pose, by measured motion. If that may be off by its whole length, or is
  // unknown, by the velocity.
  Pose predict(const Pose& last_camera_from_world, const Rig& rig, double seconds) const;
  // The same by the velocity alone; empty while it is unknown.
  std::optional<Pose> predict_by_velocity(const Pose& last_camera_from_world, double seconds) const;

 private:
  std::optional<Vector6> velocity_;
  std::optional<BodyMotion> told_ = no_motion();  // since the last pose
};

}  // namespace byre
