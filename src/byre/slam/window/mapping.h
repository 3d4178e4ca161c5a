#pragma once

#include "byre/optimise/bundle_adjustment.h"
#include "byre/slam/tracking/image_mask.h"
#include "byre/slam/window/delta.h"

namespace byre {

struct MappingOptions {
  WindowOptions window;
  int triangulation_neighbours = 6;       // online keyframes searched for new points
  int fusion_neighbours = 10;             // online keyframes searched for duplicate points
  float search_radius = 3.0f;             // pixels at octave 0 around the projection of a point of another keyframe
  double pose_sigma = 0.5;                // pixels of error between two views due to poses
  double max_relative_depth_sigma = 0.1;  // largest relative depth sigma of a new point
  // Share of a keyframe's points that are offline or seen by three others, from which it is redundant.
  double redundant_share = 0.9;
  // Weight of sightings of offline points in bundle adjustment; others have 1.
  double offline_weight = 2.0;
  // Error that neighbouring points share, pixels, in covariances of new keyframes; see with_shared_errors().
  double systematic_sigma = 0.0;
  int first_bundle_iterations = 5;   // iterations before outlier removal
  int second_bundle_iterations = 8;  // iterations after outlier removal
  ImageMask hidden{};                // cells of the newest keyframe without expected points
};

// One mapping job: triangulates new points between the new keyframes and their neighbours of both maps, fuses
// duplicates, runs local bundle adjustment, removes weak points and redundant keyframes. Offline data are fixed. Pure
// function of the window.
MapDelta extend_map(const MapWindow& window, const MappingOptions& options);

}  // namespace byre
