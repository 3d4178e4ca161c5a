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
                                                 std::span<const PoseObservation> observations,
                                                 const PoseRefinementOptions& options);

struct FocalCheckOptions {
  // Share of the focal length. A worn calibration is off by 0.003; frames of sound cameras say up to 0.007 in a
  // building and, hand-held with a rolling shutter, 0.015, but then with less than two sigmas. Of an error of 0.05 they
  // say 0.013 at least, and four sigmas: points that would tell of more are not found where they are expected.
  double max_error = 0.01;
  double min_sigmas = 3.0;  // by which it differs from none
  // What is off stays so until it is less than these shares of both bounds.
  double release = 0.5;
  int min_points = 60;   // of a frame that counts
  int asked_first = 5;   // frames, one after the other
  int asked_every = 20;  // frames, from then on
  double memory = 0.85;  // of what frames told, from one to the next
};

// Whether the points of a map that is right fit what a camera sees by the focal length it is said to have. A pose alone
// makes up for a wrong one by standing nearer or farther; the depths of points then do not fit together.
class FocalCheck {
 public:
  explicit FocalCheck(const FocalCheckOptions& options) : options_(options) {}

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
  double weight_ = 0.0;  // of all frames in the sum
  bool is_off_ = false;
  int frames_ = 0;
  int asked_ = 0;
};

}  // namespace byre
