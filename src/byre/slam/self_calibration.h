#pragma once

#include "byre/geometry/calibration_change.h"
#include "byre/slam/window.h"

#include <functional>
#include <optional>

namespace byre {

struct SelfCalibrationOptions {
  int max_keyframes = 250;    // most keyframes that take part: the time grows with their cube
  double prior_sigmas = 2.0;  // how far off a calibration is taken to be at first, in sigmas of a good one
};

// Estimates how the calibration errs from a whole map of what one rig saw: bundle adjustment in which the calibration
// moves too, together with the rows on which left and right corners were matched. The length of the baseline is held.
// Directions that the data leave open, as in degenerate motion, stay as given. Empty when too little was seen.
// given: as it was before anything was refined; present: that, changed by what is known by now, by which what the rig
// (index into whole.rigs) saw is rectified.
struct CalibrationState {
  Calibration given;
  CalibrationVector change = CalibrationVector::Zero();  // in the parameters' sigmas

  Calibration present() const { return changed(given, change); }
};
std::optional<RefinedCalibration> self_calibrate(const MapWindow& whole, const CalibrationState& state, int rig,
                                                 const SelfCalibrationOptions& options,
                                                 const std::function<bool()>& should_stop = {});

}  // namespace byre
