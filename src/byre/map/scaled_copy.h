#pragma once

#include "byre/map/map_file.h"

namespace byre {

// A pair whose baseline is so many times as long: its images, and the disparities in them, are the same. The arm to the
// body stays, as it was measured. One camera alone stays as it is.
Calibration scaled(const Calibration& calibration, double factor);

// The map and the way of its cameras, see scaled_copy of a Map; it stays where it lies on a floor plan. Recordings keep
// the calibrations that were given with them, by which the same cameras are known again; their refined ones have the
// baseline.
StoredMap scaled_copy(const StoredMap& stored, double factor);

// All lengths of a map that images tell so many times as long, also from keyframes to those that were removed. Rigs
// stay as they are. Precondition: a factor that is positive.
void stretch(Map& map, double factor);

// How many times as long as it was given the map has the baseline of a recording's pair: 1 unless its scale has been
// corrected. Also 1 for one camera alone and for a recording without keyframes. Precondition: it is listed.
double baseline_factor(const StoredMap& stored, std::size_t recording);

}  // namespace byre
