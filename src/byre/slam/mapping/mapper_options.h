#pragma once

#include "byre/slam/loops/finishing.h"
#include "byre/slam/loops/loop_closing.h"
#include "byre/slam/window/initialisation.h"
#include "byre/slam/window/mapping.h"

namespace byre {

struct MapperOptions {
  int recording = 0;                      // index for new keyframes, see Keyframe::recording
  int min_initial_points = 100;           // stereo points of the first keyframe
  double max_drift_to_fuse = 3.0;         // pixels; smaller drift is removed by fusing points around the loop
  MonocularStartOptions monocular_start;  // for monocular rigs
  MappingOptions mapping;
  LoopOptions loops;
};

}  // namespace byre
