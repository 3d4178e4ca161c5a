#pragma once

#include "byre/slam/window/map_from_poses.h"

#include <vector>

namespace byre {

struct ModelPoint {
  Eigen::Vector3d position_in_world;
  std::vector<int> images;  // images that saw the point in the model: indices into SfmModel::images
};

// A structure-from-motion model with byre's features in place of its images.
struct SfmModel {
  std::vector<Rig> rigs;
  std::vector<PosedFrame> images;
  std::vector<ModelPoint> points;
};

struct ModelMapOptions {
  float search_radius = 2.5f;   // octave pixels around a point's projection in which its corner is searched
  int max_distance = 60;        // bits between the descriptors of views of one point
  double model_sigma = 0.7;     // pixels, sigma of the model's measurements
  float max_error = 2.0f;       // octave pixels from the projection to the measured feature
  bool add_own_points = true;   // in addition to the model's
  KnownPoseOptions own_points;  // assumed_depth is taken from the model
};

struct ModelMap {
  MapGraph map{Origin::online};   // keyframe n is image n; each rig of the model is a recording
  std::vector<int> model_points;  // model point of point n; points beyond these are byre's own
};

// Converts a model to a map. Points get the similar features near their projections in the images that saw them. Points
// with fewer than two features are dropped; the others keep their positions. Position covariances are those of the
// model's own views. Most points of a model are not at corners of byre, so points for byre's own corners are added,
// triangulated from the model's poses.
ModelMap map_from_model(const SfmModel& model, const ModelMapOptions& options);

}  // namespace byre
