#pragma once

#include "byre/geometry/calibration_change.h"

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace byre {

std::string describe_calibration(const RefinedCalibration& refined);

// Row of a report on the calibration given to a run; empty if it was not refined. row_error: by CommonRowError; empty
// without pairs.
std::string calibration_row(const std::optional<RefinedCalibration>& refined, const std::optional<double>& row_error);

// Table of the parameters: change, and standard errors before and after.
std::string calibration_table(const RefinedCalibration& refined);

// Warning if the calibration given is off, by row errors as in "byre check", or by an implausible change.
std::optional<std::string> calibration_warning(const std::optional<RefinedCalibration>& refined,
                                               const std::optional<double>& row_error);

nlohmann::ordered_json calibration_json(const RefinedCalibration& refined);

}  // namespace byre
