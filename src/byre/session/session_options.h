#pragma once

#include "byre/image_condition.h"
#include "byre/localisation/mission.h"
#include "byre/mapping/anchored_trajectory.h"
#include "byre/mapping/mapper_options.h"
#include "byre/slam/health.h"
#include "byre/slam/hindsight.h"
#include "byre/slam/keyframes.h"
#include "byre/slam/localisation.h"
#include "byre/slam/state.h"
#include "byre/slam/tracking.h"

namespace byre {

// Each leaf stands here once, and is handed to every function that needs it.
struct SessionOptions {
  int recording = 0;       // index that new keyframes get, see Keyframe::recording
  bool is_planar = false;  // a mission holds the body to the ground that the map was driven on, see planar_prior
  bool map_online = true;  // false: track on the offline map alone
  int min_initial_points = MapperOptions{}.min_initial_points;  // see there
  int local_keyframes = 15;     // keyframes of either map whose points are looked for in a frame
  double min_kept_share = 0.5;  // share of the last inliers; with fewer the pose is sought without prediction too
  double max_drift_to_fuse = MapperOptions{}.max_drift_to_fuse;  // see there
  MonocularStartOptions monocular_start;                         // start with a rig that has no baseline
  TrackOptions track;
  KeyframeOptions keyframes;
  WindowOptions window;                                                         // window of local mapping
  double max_relative_depth_sigma = MappingOptions{}.max_relative_depth_sigma;  // see there
  double redundant_share = MappingOptions{}.redundant_share;                    // see there
  LocaliseOptions relocalise;  // where the frame is looked for in the whole map, once lost
  LoopOptions loops;
  MissionOptions mission;
  HealthOptions health;
  ImageConditionOptions image;
  StateOptions state;
  HindsightOptions hindsight;
  TrajectoryOptions trajectory;
};

// What the session's mapper goes by, its offline weight that of tracking.
MapperOptions mapper_options(const SessionOptions& options);

}  // namespace byre
