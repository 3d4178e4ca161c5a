#pragma once

#include "byre/optimise/pose_refinement.h"

#include <optional>
#include <span>

namespace byre {

// Sums of squared reprojection errors of a frame after pose refinement with the present focal length, and with one
// shorter or longer by the share kFocalStep. Square pixels, bounded for each point.
struct FocalEvidence {
  double shorter = 0.0;
  double present = 0.0;
  double longer = 0.0;
  double points = 0.0;
};

constexpr double kFocalStep = 0.05;

// camera_from_world: refined with the present focal length; initial value for the other two. max_error: bound of an
// error, pixels; larger ones are wrong matches. Empty if a refinement fails.
std::optional<FocalEvidence> compare_focal_lengths(const Pose& camera_from_world, const Rig& rig,
                                                   std::span<const PoseObservation> observations,
                                                   double max_error = 4.0);

// Detects a wrong focal length of the calibration from points of a correct map. A pose alone compensates a wrong focal
// length by its distance; points at different depths then disagree.
class FocalCheck {
 public:
  // Whether to weigh the next frame: each until five were weighed, then every twentieth. Call it once for each frame.
  bool is_due();
  void note(const FocalEvidence& evidence);

  // Relative error of the focal length, positive if too long; 0 without evidence.
  double error() const;
  // error() in standard deviations of a single frame: the errors of one view repeat in the next.
  double sigmas() const;
  bool is_off() const { return is_off_; }

 private:
  FocalEvidence sum_;
  double weight_ = 0.0;  // number of frames in the sum, with decay
  bool is_off_ = false;
  int frames_ = 0;
  int checked_ = 0;
};

}  // namespace byre
