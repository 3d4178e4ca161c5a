#pragma once

#include "byre/playback/map_run.h"

#include <string>

namespace byre {

// Report rows on wheel and gyroscope calibration and on poses from dead reckoning. Empty without such sensors.
// has_metric_source: the cameras are a metric source (a stereo pair, or a map).
std::string motion_rows(const MapRun& run, bool has_metric_source);

}  // namespace byre
