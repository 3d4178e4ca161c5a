#pragma once

#include "byre/playback/play.h"
#include "byre/playback/report/report.h"

namespace byre {

// Adds rows on wheel and gyroscope calibration and on poses from dead reckoning. None without such sensors.
// has_metric_source: the cameras are a metric source (a stereo pair, or a map).
void add_motion(const RunResult& run, bool has_metric_source, Report& report);

}  // namespace byre
