#pragma once

#include "byre/map/map_file.h"
#include "byre/motion/known_mounting.h"

#include <vector>

namespace byre {

// Mounting of wheels and gyroscope from a map's notes, for the body of the given cameras. Empty if no recording is by
// these cameras.
KnownMounting mounting_for(const KnownMounting& of_map, const std::vector<SourceRecording>& recordings,
                           const Calibration& given);

}  // namespace byre
