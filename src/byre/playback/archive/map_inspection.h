#pragma once

#include "byre/geometry/evaluation/distribution.h"
#include "byre/map/map_file.h"

#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace byre {

struct MapCounts {
  int keyframes = 0;
  int keyframes_with_words = 0;
  int keyframes_with_picture = 0;
  std::size_t picture_bytes = 0;
  std::vector<int> keyframes_of_recordings;
  int points = 0;
  int features = 0;
  int observations = 0;
  int patches = 0;
};

// Distances between observations and projections of their points.
struct ReprojectionErrors {
  Distribution pixel;      // pixels, of all observations
  Distribution disparity;  // pixels, of observations with a disparity
  int behind_camera = 0;   // observations of a point not in front of its camera; excluded from both distributions
};

struct MapInspection {
  MapCounts counts;
  std::vector<std::string> cameras_of_recordings;  // stereo, rgbd or mono
  Distribution observations_per_point;
  ReprojectionErrors errors;
  Eigen::AlignedBox3d points_in_world;  // empty without points
  double path_length = 0.0;             // metres along the keyframes' body poses, summed over recordings
  std::vector<SectionSize> memory;      // size of the loaded map, per kind of data
  std::vector<std::string> faults;
};

MapInspection inspect(const StoredMap& stored);

}  // namespace byre
