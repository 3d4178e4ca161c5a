#pragma once

#include "byre/geometry/calibration_change.h"

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace byre {

// The refinement in a sentence.
std::string describe_calibration(const RefinedCalibration& refined);

// One row of a report on the calibration that a run was given; nothing where it was not refined. row_error: by
// CommonRowError, where there are pairs.
std::string calibration_row(const std::optional<RefinedCalibration>& refined, const std::optional<double>& row_error);

// A row for each parameter: its change, and its standard errors before and after.
std::string calibration_table(const RefinedCalibration& refined);

// A warning where the calibration given is off: by rows as in "byre check", or by a change that is implausible.
std::optional<std::string> calibration_warning(const std::optional<RefinedCalibration>& refined,
                                               const std::optional<double>& row_error);

nlohmann::ordered_json calibration_json(const RefinedCalibration& refined);

}  // namespace byre
