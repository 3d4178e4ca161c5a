#pragma once

#include "byre/optimise/pose_refinement.h"

#include <optional>
#include <span>

namespace byre {

// How far points lie off where a frame sees them, on the whole, once its pose is refined with the focal length as it
// is, and with one that is shorter and longer by kFocalStep. Square pixels; single points count up to a bound.
struct FocalEvidence {
  double shorter = 0.0;
  double as_it_is = 0.0;
  double longer = 0.0;
  double points = 0.0;
};

constexpr double kFocalStep = 0.05;

// The pose is refined already as it is, and the guess for the other two. Empty where one of them finds none.
std::optional<FocalEvidence> weigh_focal_lengths(const Pose& camera_from_world, const Rig& rig,
                                                 std::span<const PoseObservation> observations);

struct FocalCheckOptions {
  int asked_first = 5;   // frames, one after the other
  int asked_every = 20;  // frames, from then on
};

// Whether the points of a map that is right fit what a camera sees by the focal length it is said to have. A pose alone
// makes up for a wrong one by standing nearer or farther; the depths of points then do not fit together.
class FocalCheck {
 public:
  explicit FocalCheck(const FocalCheckOptions& options = {}) : options_(options) {}

  // Whether the next frame is to be asked. Call it once for each frame.
  bool is_due();
  void note(const FocalEvidence& evidence);

  // By which share the focal length is too long; 0 while nothing is known.
  double error() const;
  // The error in its standard deviations, as one frame knows it: what a view says wrongly, the next one repeats.
  double sigmas() const;
  bool is_off() const { return is_off_; }

 private:
  FocalCheckOptions options_;
  FocalEvidence sum_;
  double weight_ = 0.0;  // number of frames in the sum, older ones counting less
  bool is_off_ = false;
  int frames_ = 0;
  int asked_ = 0;
};

}  // namespace byre
