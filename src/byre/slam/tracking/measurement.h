#pragma once

#include "byre/features.h"
#include "byre/rig.h"

namespace byre {

// One camera's view for the duration of a call; borrows features and rig.
struct CameraView {
  const Features& features;
  const Rig& rig;
  Pose camera_from_world;
};

// A feature of a view, with the pixel of the point.
struct ViewedFeature {
  const CameraView& view;
  int feature = 0;
  Eigen::Vector2f pixel;  // full-resolution pixels
};

struct PixelMeasurement {
  Eigen::Vector2f pixel;  // full-resolution pixels
  float sigma = 1.0f;     // pixels, of u and of v
  bool aligned = false;   // refined in the image, not only a corner
  bool differs = false;   // both views have a patch, and these do not fit
};

// Subpixel measurement by the current view's feature of the point that the reference shows: the reference's patch,
// warped by the poses (a plane that faces the reference camera), is aligned with the feature's patch. Without patches,
// or if the alignment fails, the corner with its larger sigma.
PixelMeasurement measure_pixel(const ViewedFeature& reference, const Eigen::Vector3d& point_in_world,
                               const CameraView& current, int feature);

// Measurement by the detected corner alone.
PixelMeasurement corner_measurement(const Keypoint& keypoint);

// Sigma of a point's own reference pixel, which defines it; that of a corner without a patch. Pixels.
float reference_sigma(const Features& features, int feature);

}  // namespace byre
