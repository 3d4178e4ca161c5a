#pragma once

#include "byre/map/map_file.h"
#include "byre/motion/known_mounting.h"

#include <vector>

namespace byre {

// How wheels and a gyroscope are mounted, as a map knows it, for the body that these cameras sit on; empty where none
// of its recordings is by them.
KnownMounting mounting_for(const KnownMounting& of_map, const std::vector<SourceRecording>& recordings,
                           const Calibration& given);

}  // namespace byre
