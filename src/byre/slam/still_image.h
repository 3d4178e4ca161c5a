#pragma once

#include "byre/body_motion.h"
#include "byre/features.h"
#include "byre/features/rolling_shutter.h"
#include "byre/rig.h"

#include <optional>
#include <vector>

namespace byre {

// Whether the image stands still, and whether that contradicts the motion of the camera.
struct Stillness {
  bool is_still = false;   // most corners are where an earlier frame had them
  bool is_frozen = false;  // although the camera has moved: the image is repeated with noise
  double seconds = 0.0;    // since that earlier frame
};

// Detects an image that is repeated with sensor noise, which no checksum finds. Compares corners with those of the
// first frame of a standstill. The standstill is contradicted by measured motion (wheels, gyroscope) that would have
// moved the corners. Without such a measurement it is contradicted by a stop from steady motion within one frame,
// beyond the deceleration of robots. A contradiction lasts until the image moves, or until the measured motion since
// the standstill began is within what a trusted pose allows.
class StillImage {
 public:
  // measured: motion of the body since the frame before, where known. before: motion of the camera up to that frame.
  // Precondition: frames come in order of time, features as the camera shows them.
  Stillness note(const Frame& frame, const Rig& rig, const std::optional<BodyMotion>& measured,
                 const CameraMotion& before);
  // The frame shows too little to compare.
  void forget() { reference_.clear(); }

 private:
  // A corner of the first frame of the standstill.
  struct ReferenceCorner {
    Keypoint keypoint;
    Descriptor descriptor;
  };
  // Where that corner is, and whether the frame has it at the same place.
  struct Corner {
    Eigen::Vector2d pixel;
    Eigen::Vector3d in_camera;
    bool stays = false;
  };

  void compare(const Features& features, const Rig& rig, double depth);
  bool is_contradicted_by(const Pose& now_from_then, const Rig& rig) const;
  bool is_sudden_stop(const Vector6& later, double seconds, const Rig& rig) const;
  void restart(const Frame& frame, const Vector6& velocity);

  std::vector<ReferenceCorner> reference_;  // empty: there is none
  Timestamp since_{};                       // time of the reference
  Vector6 velocity_ = Vector6::Zero();      // velocity of the camera before the reference, per second
  std::optional<Vector6> stopped_from_;     // velocity at the reference, once known
  std::optional<BodyMotion> measured_;      // since the reference; empty: not known
  bool is_contradicted_ = false;
  std::vector<Corner> corners_;  // memory
};

}  // namespace byre
