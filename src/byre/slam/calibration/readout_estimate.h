#pragma once

#include "byre/slam/tracking/tracking.h"

namespace byre {

// Evidence of a frame's points on the error of the readout time, positive if it is longer than assumed: the normal
// equation of that one number, with the frame's pose eliminated.
struct ReadoutEvidence {
  double information = 0.0;  // 1 / s^2
  double right_side = 0.0;   // 1 / s
  int points = 0;            // number of points

  ReadoutEvidence& operator+=(const ReadoutEvidence& other);
};

// velocity: of the camera, see CameraMotion. The frame's corners are corrected by the assumed readout time. Includes
// outliers of the pose: a wrong readout time shows there first. Empty if the camera hardly turns: in straight motion a
// calibration error looks the same in each frame, and much like a rolling shutter.
ReadoutEvidence readout_evidence(const Frame& frame, const Rig& rig, const TrackedFrame& tracked, const MapView& map,
                                 const Vector6& velocity);

// Estimates the readout time of a rolling shutter from frame to frame. Errors that are not proportional to the camera's
// motion, such as those of the calibration, average out over turns in both directions; the sigma is estimated from the
// differences between blocks of frames. A map made with a wrong readout time absorbs part of its effect, so the
// estimate converges in several changes.
class ReadoutEstimator {
 public:
  explicit ReadoutEstimator(double readout_time) : readout_time_(readout_time) {}

  double readout_time() const { return readout_time_; }  // seconds

  // Changes the readout time once there is enough evidence, and then discards that evidence.
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
    double effect() const;  // effect on measurements, without the part that the pose absorbs; sigmas, root mean square
  };

  bool is_significant() const;

  double readout_time_;
  ReadoutEvidence block_;  // present block
  int frames_in_block_ = 0;
  Blocks blocks_;
};

}  // namespace byre
