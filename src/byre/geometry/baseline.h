#pragma once

#include "byre/calibration.h"

#include <optional>
#include <string>

namespace byre {

// Baselines of stereo pairs that are accepted without confirmation, metres. KITTI's car has 0.54 m. Beyond, extrinsics
// in millimetres or centimetres are the likelier explanation, and images alone cannot disprove it: they show the
// building larger in proportion.
inline constexpr double kShortestBaseline = 0.002;
inline constexpr double kLongestBaseline = 1.0;

double baseline_of(const Calibration& calibration);  // metres; 0 for one camera

// The calibration with a checked baseline. confirmed: the baseline in metres; replaces the length that the calibration
// has. Without it a baseline out of range throws InputError. place: the calibration in messages; option: the name of
// the option that confirms a baseline, with a space or "= " before its value.
Calibration with_checked_baseline(Calibration calibration, const std::optional<double>& confirmed,
                                  const std::string& place, const std::string& option);

}  // namespace byre
