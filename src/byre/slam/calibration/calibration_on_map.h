#pragma once

#include "byre/geometry/calibration_sensitivity.h"
#include "byre/map/map_view.h"
#include "byre/slam/tracking/tracking.h"

namespace byre {

// Standard error of lengths by the disparities of a frame, as a share, after a calibration was refined; 0 without any.
// The disparities have an error in common that no estimate removes, of the calibration and of matching: on rendered
// missions 0.07 to 0.11 pixels were left. Least squares: near points, which determine the motion, count most.
double length_sigma(const Features& features);

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

  // Standard error of lengths by the disparities of a frame relative to the map's, as a share: length_sigma() of the
  // frame, the posterior of the calibration, and the part of its estimate that change does not contain.
  double length_sigma(const Features& features, const CalibrationVector& change) const;

 private:
  void add_rows(const Features& features, const CalibrationVector& change);
  CalibrationMatrix posterior() const;  // information, with the prior

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
