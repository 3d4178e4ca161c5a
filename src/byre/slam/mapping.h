#pragma once

#include "byre/optimise/bundle_adjustment.h"
#include "byre/slam/delta.h"
#include "byre/slam/hidden_cells.h"

namespace byre {

struct MappingOptions {
  WindowOptions window;
  int triangulation_neighbours = 6;       // online keyframes searched for new points
  int fusion_neighbours = 10;             // online keyframes searched for points seen twice
  float search_radius = 3.0f;             // pixels at octave 0, about where a point of another keyframe should be
  double pose_sigma = 0.5;                // pixels that errors of the poses may add between two views
  double max_relative_depth_sigma = 0.1;  // a new point's depth must be known to this share of itself
  double redundant_share = 0.9;           // share of a redundant keyframe's points offline or seen by three others
  double offline_weight = 2.0;            // weight of sightings of offline points in bundle adjustment; others have 1
  int first_bundle_iterations = 5;        // iterations before outliers are taken out
  int second_bundle_iterations = 8;       // iterations after outliers were taken out
  HiddenCells hidden{};                   // cells of the newest keyframe in which points are not missed
};

// One mapping job: new points between the new keyframes and their neighbours, online and offline, points seen twice
// fused, local bundle adjustment, weak points and redundant keyframes removed. What is offline is held fixed, and what
// is online adapts to it. Pure: the window in, what is to change out.
MapDelta extend_map(const MapWindow& window, const MappingOptions& options);

}  // namespace byre
