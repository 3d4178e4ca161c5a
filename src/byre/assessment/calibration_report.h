#pragma once

#include "byre/geometry/calibration_change.h"

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace byre {

// From so many pixels on a calibration is so far off that its camera should be looked at.
inline constexpr double kFarOffPixels = 0.5;

// In a sentence.
std::string describe_calibration(const RefinedCalibration& refined);

// What a run says of the calibration it was given: one row of a report, or nothing where it was not refined.
std::string calibration_row(const std::optional<RefinedCalibration>& refined);

// A row for each parameter: by how much it was changed, and how well it was known before and is now.
std::string calibration_table(const RefinedCalibration& refined);

// A warning with the number where the calibration given is far off.
std::optional<std::string> calibration_warning(const std::optional<RefinedCalibration>& refined);

nlohmann::ordered_json calibration_json(const RefinedCalibration& refined);

}  // namespace byre
