#pragma once

#include "byre/geometry/calibration_sensitivity.h"
#include "byre/map/map_view.h"
#include "byre/slam/tracking.h"

#include <optional>

namespace byre {

// What a mission tells of the calibration of its cameras: its frames see points of the offline map, which are known.
// A frame adds its share of the normal equations with its pose eliminated, so nothing but a sum is kept. Of one rig.
class CalibrationOnMap {
 public:
  // given: by which the rig's images are rectified. Throws InputError when that cannot be done.
  // prior_sigmas: how far off the calibration is taken to be at first, in sigmas of a good one.
  CalibrationOnMap(const Calibration& given, double prior_sigmas);

  // A frame that was tracked by the calibration given, changed by what was found since (in the parameters' sigmas):
  // features, rig and pose are as the changed one has them.
  void add(const Frame& frame, const Rig& rig, const TrackedFrame& tracked, const MapView& map,
           const CalibrationVector& change);

  int frames() const { return frames_; }

  // What all frames so far say.
  RefinedCalibration estimate() const;

 private:
  void add_rows(const Features& features, const CalibrationVector& change);

  // Constant after construction.
  Calibration given_;
  double prior_sigmas_;
  CalibrationSensitivity sensitivity_;

  CalibrationMatrix information_ = CalibrationMatrix::Zero();
  CalibrationVector right_side_ = CalibrationVector::Zero();
  int frames_ = 0;
  int observations_ = 0;
};

}  // namespace byre
