#pragma once

#include "byre/slam/map_from_poses.h"

#include <vector>

namespace byre {

struct ModelPoint {
  Eigen::Vector3d position_in_world;
  std::vector<int> images;  // images that saw the point when the model was made: indices into SfmModel::images
};

// A structure-from-motion model, its images replaced by what byre extracts from them.
struct SfmModel {
  std::vector<Rig> rigs;
  std::vector<PosedFrame> images;
  std::vector<ModelPoint> points;
};

struct ModelMapOptions {
  float search_radius = 2.5f;   // octave pixels about a point's projection in which its corner is looked for
  int max_distance = 60;        // bits between the descriptors of views of one point
  double model_sigma = 0.7;     // pixels, of the measurements that the model was made of
  float max_error = 2.0f;       // octave pixels from the projection to where a feature is measured to show the point
  bool add_own_points = true;   // besides the model's
  KnownPoseOptions own_points;  // their assumed depth is taken from the model
};

// What became of a model.
struct ModelMap {
  Map map{Origin::online};        // keyframe n is image n, of a recording for each rig of the model
  std::vector<int> model_points;  // which of the model's points point n is; points beyond these are byre's own
};

// Makes a map of a model: points get the features that lie where they project in the images that saw them, as far as
// the features look alike. Points with fewer than two are left out; the others stay where they are. Positions'
// covariances are those that the model's own views give. As most points of a model lie where byre sees no corner,
// points for byre's own corners are added, triangulated from the model's poses.
ModelMap map_from_model(const SfmModel& model, const ModelMapOptions& options);

}  // namespace byre
