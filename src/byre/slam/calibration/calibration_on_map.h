#pragma once

#include "byre/geometry/calibration_sensitivity.h"
#include "byre/map/map_view.h"
#include "byre/slam/tracking/tracking.h"

namespace byre {

// Calibration estimate from a mission's observations of offline points, whose positions are given. A frame adds normal
// equations with its pose eliminated, so only a sum is stored. For one rig.
class CalibrationOnMap {
 public:
  // given: calibration that rectifies the rig's images. Throws InputError if it cannot. prior_sigmas: standard
  // deviation of the given calibration, in sigmas of a good one.
  CalibrationOnMap(const Calibration& given, double prior_sigmas);

  // Adds a frame tracked with the given calibration plus change (in the parameters' sigmas), which features, rig and
  // pose correspond to.
  void add(const Frame& frame, const Rig& rig, const TrackedFrame& tracked, const MapView& map,
           const CalibrationVector& change);

  int frames() const { return frames_; }

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
