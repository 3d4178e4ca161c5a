#pragma once

#include "byre/geometry/calibration_change.h"
#include "byre/playback/play.h"
#include "byre/playback/report/report.h"

#include <optional>
#include <string>

namespace byre {

nlohmann::ordered_json calibration_json(const RefinedCalibration& refined);
std::string describe_calibration(const RefinedCalibration& refined);

// Adds the description and a table of the parameters: change, and standard errors before and after.
void add_calibration(const RefinedCalibration& refined, Report& report);

// Warning if the calibration given is off, by row errors as in "byre check", or by an implausible change.
std::optional<std::string> calibration_warning(const std::optional<RefinedCalibration>& refined,
                                               const std::optional<double>& row_error);

// Adds rows on wheel and gyroscope calibration and on poses from dead reckoning. None without such sensors.
// has_metric_source: the cameras are a metric source (a stereo pair, or a map).
void add_motion(const RunResult& run, bool has_metric_source, Report& report);

}  // namespace byre
