#pragma once

#include "byre/calibration.h"

#include <optional>
#include <string>

namespace byre {

// Range of baselines that are accepted without confirmation, metres. KITTI's car has 0.54 m. For others, extrinsics in
// millimetres or centimetres are likelier. Images cannot disprove them, as they only scale the scene.
inline constexpr double kShortestBaseline = 0.002;
inline constexpr double kLongestBaseline = 1.0;

// Range of baselines that can be confirmed, metres.
inline constexpr double kShortestConfirmed = 1e-4;
inline constexpr double kLongestConfirmed = 10.0;

double baseline_of(const Calibration& calibration);  // metres; 0 for one camera

// The calibration with a checked baseline. confirmed: baseline in metres that replaces that of the calibration; if it
// is empty, a baseline out of range throws InputError. place: name of the calibration in messages; option: the option
// that confirms a baseline, up to its value ("--baseline ").
Calibration with_checked_baseline(Calibration calibration, const std::optional<double>& confirmed,
                                  const std::string& place, const std::string& option);

}  // namespace byre
