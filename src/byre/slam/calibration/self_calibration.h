#pragma once

#include "byre/geometry/calibration_change.h"
#include "byre/slam/window/window.h"

#include <functional>
#include <optional>
#include <vector>

namespace byre {

struct SelfCalibrationOptions {
  int max_keyframes = 250;    // keyframes used; the time grows with their cube
  double prior_sigmas = 2.0;  // standard deviation of a calibration before refinement, in sigmas of a good one
};

// The calibration before any refinement, and its change so far.
struct CalibrationState {
  Calibration given;
  CalibrationVector change = CalibrationVector::Zero();  // in the parameters' sigmas

  Calibration present() const { return changed(given, change); }
};

// A refined calibration, with the map's geometry in images rectified by it.
struct SelfCalibration : RefinedCalibration {
  // New poses camera_from_world and positions in world, with indices into the window. Empty if the refined calibration
  // is not that of the geometry: directions stay as given, or the change is refused.
  std::vector<std::pair<int, Pose>> keyframes_moved;
  std::vector<std::pair<int, Eigen::Vector3d>> points_moved;
};

// Estimates the calibration error of a rig (index into whole.rigs) from a whole map: bundle adjustment with a free
// calibration, together with the rows of corners matched between both images. The length of the baseline is fixed.
// Directions that the data do not determine, as in degenerate motion, stay as given. A
// calibration of one camera that its images refute is refined with the wide prior of nominal numbers instead. Empty if
// too little was seen.
// Precondition: the rig's images are rectified by state.present().
std::optional<SelfCalibration> self_calibrate(const MapWindow& whole, const CalibrationState& state, int rig,
                                              const SelfCalibrationOptions& options,
                                              const std::function<bool()>& should_stop = {});

}  // namespace byre
