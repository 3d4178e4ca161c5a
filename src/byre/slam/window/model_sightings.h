#pragma once

#include "byre/slam/tracking/measurement.h"
#include "byre/slam/window/map_from_model.h"

#include <optional>
#include <vector>

namespace byre {

// A feature that shows a point of a model.
struct ModelView {
  int image = 0;  // index into SfmModel::images
  int feature = 0;
  float offset = 0.0f;  // octave pixels from the projection of the point
};

struct ModelSightings {
  int point = 0;                 // index into SfmModel::points
  std::vector<ModelView> views;  // ascending by image, at least two
};

// Features that show the model's points: near the projection in the images that saw the point, with similar
// descriptors. A feature shows one point only. Points with fewer than two features are dropped; the others are
// ascending.
std::vector<ModelSightings> find_sightings(const SfmModel& model, const ModelMapOptions& options);

// View whose descriptor is most similar to those of the other images. Precondition: views by image, at least one.
const ModelView& most_central(const SfmModel& model, const std::vector<ModelView>& views);

CameraView view_of(const SfmModel& model, int image);

// Empty behind the camera.
std::optional<Eigen::Vector2d> project(const CameraView& view, const Eigen::Vector3d& point_in_world);

// Measurement of a point by a feature; empty if it is more than max_error (octave pixels) off the projection.
std::optional<PixelMeasurement> measure_against(const ViewedFeature& reference, const Eigen::Vector3d& point_in_world,
                                                const CameraView& view, int feature, float max_error);

}  // namespace byre
