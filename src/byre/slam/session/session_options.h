#pragma once

#include "byre/image_condition.h"
#include "byre/slam/frame/health.h"
#include "byre/slam/frame/state.h"
#include "byre/slam/localisation/mission.h"
#include "byre/slam/mapping/anchored_trajectory.h"
#include "byre/slam/mapping/mapper_options.h"
#include "byre/slam/places/localisation.h"
#include "byre/slam/tracking/deferred_refinement.h"
#include "byre/slam/tracking/keyframes.h"
#include "byre/slam/tracking/tracking.h"

namespace byre {

// Options of all parts of a session. Each value occurs once and is passed to all functions that need it.
struct SessionOptions {
  int recording = 0;       // index of new keyframes, see Keyframe::recording
  bool is_planar = false;  // constrains a mission's body to the ground that the map was driven on, see planar_prior
  bool map_online = true;  // false: track on the offline map alone
  int min_initial_points = MapperOptions{}.min_initial_points;
  int local_keyframes = 15;     // keyframes of either map whose points are matched
  double min_kept_share = 0.5;  // share of the last inliers; fewer start a search without the prediction too
  double max_drift_to_fuse = MapperOptions{}.max_drift_to_fuse;
  MonocularStartOptions monocular_start;  // for a rig without baseline
  TrackOptions track;
  KeyframeOptions keyframes;
  WindowOptions window;  // window of local mapping
  double max_relative_depth_sigma = MappingOptions{}.max_relative_depth_sigma;
  double redundant_share = MappingOptions{}.redundant_share;
  LocaliseOptions relocalise;  // localisation in the whole map after a loss
  LoopOptions loops;
  MissionOptions mission;
  HealthOptions health;
  ImageConditionOptions image;
  StateOptions state;
  DeferredRefinementOptions deferred_refinement;
  TrajectoryOptions trajectory;
};

// Options of the session's mapper; its offline weight is that of tracking.
MapperOptions mapper_options(const SessionOptions& options);

}  // namespace byre
