#pragma once

#include "byre/body_motion.h"
#include "byre/features.h"
#include "byre/features/rolling_shutter.h"
#include "byre/rig.h"

#include <optional>
#include <vector>

namespace byre {

// Whether the image is at standstill, and whether that contradicts the motion of the camera.
struct Stillness {
  bool is_still = false;   // many corners are where an earlier frame had them
  bool is_frozen = false;  // is_still although the camera moved: the image is repeated with noise
  double seconds = 0.0;    // time since that earlier frame
};

// Detects an image that is repeated with sensor noise, which a checksum cannot detect. Compares corners with those of
// the first frame of a standstill. Measured motion (wheels, gyroscope) that would have moved the corners contradicts
// the standstill. Without such a measurement, a stop from steady motion within one frame, beyond the deceleration of
// robots, contradicts it. A contradiction lasts until the image moves, or until the measured motion since the
// standstill began is within the error of a trusted pose.
class StillImage {
 public:
  // measured: motion of the body since the frame before; empty: unknown. before: motion of the camera up to that frame.
  // Precondition: frames in order of time, features without rolling-shutter correction.
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
  // Position of a reference corner, and whether the frame has it at the same place.
  struct Corner {
    Eigen::Vector2d pixel;
    Eigen::Vector3d in_camera;
    bool stays = false;
  };

  void compare(const Features& features, const Rig& rig, double depth);
  bool is_contradicted_by(const Pose& now_from_then, const Rig& rig) const;
  bool is_sudden_stop(const Vector6& later, double seconds, const Rig& rig) const;
  void restart(const Frame& frame, const Vector6& velocity);

  std::vector<ReferenceCorner> reference_;  // empty: none
  Timestamp since_{};                       // time of the reference
  Vector6 velocity_ = Vector6::Zero();      // velocity of the camera before the reference, per second
  std::optional<Vector6> stopped_from_;     // velocity at a sudden stop, else zero; empty for the reference alone
  std::optional<BodyMotion> measured_;      // motion since the reference; empty: unknown
  bool is_contradicted_ = false;
  std::vector<Corner> corners_;  // buffer
};

}  // namespace byre
