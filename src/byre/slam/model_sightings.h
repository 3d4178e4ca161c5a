#pragma once

#include "byre/slam/map_from_model.h"
#include "byre/slam/measurement.h"

#include <optional>
#include <vector>

namespace byre {

// A feature that shows a point of a model.
struct ModelView {
  int image = 0;  // index into SfmModel::images
  int feature = 0;
  float offset = 0.0f;  // octave pixels from where the point projects
};

struct ModelSightings {
  int point = 0;                 // index into SfmModel::points
  std::vector<ModelView> views;  // by image, ascending; two at least
};

// The features that show the model's points: near to where a point projects in the images that saw it, and alike. A
// feature shows one point only. Points with fewer than two are left out, the others ascending.
std::vector<ModelSightings> find_sightings(const SfmModel& model, const ModelMapOptions& options);

// The view whose descriptor is most like those of the other images. Precondition: views by image, one at least.
const ModelView& most_central(const SfmModel& model, const std::vector<ModelView>& views);

CameraView view_of(const SfmModel& model, int image);

// Empty behind the camera.
std::optional<Eigen::Vector2d> project(const CameraView& view, const Eigen::Vector3d& point_in_world);

// A feature's measurement of a point; empty when the image shows the point farther than max_error (octave pixels) from
// where it projects.
std::optional<PixelMeasurement> measure_against(const ViewedFeature& reference, const Eigen::Vector3d& point_in_world,
                                                const CameraView& view, int feature, float max_error);

}  // namespace byre
