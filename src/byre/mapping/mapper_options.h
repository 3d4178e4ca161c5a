#pragma once

#include "byre/slam/finishing.h"
#include "byre/slam/initialisation.h"
#include "byre/slam/loop_closing.h"
#include "byre/slam/mapping.h"

namespace byre {

struct MapperOptions {
  int recording = 0;                      // index that new keyframes get, see Keyframe::recording
  int min_initial_points = 100;           // stereo points of the first keyframe
  double max_drift_to_fuse = 3.0;         // pixels: what has drifted less is found again by fusing points around it
  MonocularStartOptions monocular_start;  // start with a rig that has no baseline
  MappingOptions mapping;
  LoopOptions loops;
};

}  // namespace byre
