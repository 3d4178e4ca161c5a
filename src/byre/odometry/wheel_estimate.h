#pragma once

#include "byre/odometry/calibrated_odometry.h"
#include "byre/odometry/visual_motion.h"
#include "byre/odometry/wheel_calibration.h"

#include <deque>
#include <optional>
#include <vector>

namespace byre {

// Largest sigma of a usable estimate: relative for the scale, radians for the rotation.
inline constexpr double kMaxEstimateSigma = 0.05;
inline constexpr double kMaxFirstEstimateSigma = 0.2;  // for the first estimate

// Motions that wheels measured as well.
std::vector<MotionPair> pairs_of(const std::deque<VisualMotion>& seen, const CalibratedOdometry& odometry);

// Sum of all paths by wheels, metres.
double way_of(const std::vector<MotionPair>& motions);

// Whether the base drove and turned enough for an estimate without a prior.
bool determine_calibration(const std::vector<MotionPair>& motions);

bool is_determined(const std::optional<WheelCalibration>& calibration, double max_sigma);

// Empty while motions do not determine the calibration.
std::optional<WheelCalibration> estimate_without_prior(const std::vector<MotionPair>& motions);

// Empty while prior and motions do not determine the calibration.
std::optional<WheelCalibration> estimate_with_prior(const std::vector<MotionPair>& motions,
                                                    const WheelCalibration& prior);

// Calibration without the prior, if it fits the motions of a whole drive clearly better than the prior allows.
std::optional<WheelCalibration> better_without_prior(const std::vector<MotionPair>& motions,
                                                     const WheelCalibration& prior);

// Standard error of the scale by its scatter among parts of the drive, as a natural logarithm: larger than that of
// independent errors if the unit of the map drifted. Zero if no part determines it.
double scale_scatter(const std::vector<MotionPair>& motions, const WheelCalibration& whole);

}  // namespace byre
