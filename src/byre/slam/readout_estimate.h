#pragma once

#include "byre/slam/tracking.h"

namespace byre {

// What the points of a frame say of how much longer its rows take to be read than is thought: the normal equation of
// that one number, with the frame's pose eliminated.
struct ReadoutEvidence {
  double information = 0.0;  // 1 / s^2
  double right_side = 0.0;   // 1 / s
  int points = 0;            // points that were asked

  ReadoutEvidence& operator+=(const ReadoutEvidence& other);
};

// velocity: of the camera, as CameraMotion has it. The frame's corners are where the readout time that is thought has
// them. Outliers of the pose are asked too: where that time is wrong, it is they who know. Nothing where the camera
// hardly turns: to who drives ahead a calibration that errs looks the same in each frame, and much like a rolling
// shutter.
ReadoutEvidence readout_evidence(const Frame& frame, const Rig& rig, const TrackedFrame& tracked, const MapView& map,
                                 const Vector6& velocity);

// Finds out how long a rolling shutter takes to read an image, from frame to frame. What errs otherwise than in
// proportion to the camera's motion, such as a calibration, averages out as the camera turns hither and thither: how
// sure the sum is comes from how blocks of frames differ. A map that was made by a wrong time takes up part of what it
// does, so that the right one is come to in several changes.
class ReadoutEstimator {
 public:
  explicit ReadoutEstimator(double readout_time) : readout_time_(readout_time) {}

  double readout_time() const { return readout_time_; }  // seconds

  // The readout time changes where enough was noted; what led to it counts no longer then.
  void note(const ReadoutEvidence& evidence);

 private:
  // Sums over blocks.
  struct Blocks {
    int count = 0;
    ReadoutEvidence sum;
    double right_side_squared = 0.0;
    double information_squared = 0.0;
    double product = 0.0;

    void add(const ReadoutEvidence& block);
    double change() const { return sum.right_side / sum.information; }  // seconds
    double sigma() const;                                               // sigma of the change, seconds
    double effect() const;  // effect on what is measured, but for what the pose takes up; sigmas, root mean square
  };

  bool is_sure() const;

  double readout_time_;
  ReadoutEvidence block_;  // so far
  int frames_in_block_ = 0;
  Blocks blocks_;
};

}  // namespace byre
