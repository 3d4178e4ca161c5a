#include "byre/slam/tracking/measurement.h"

#include "byre/features/align.h"

#include <cmath>

namespace byre {
namespace {

// Octave pixels. A FAST corner moves by about a pixel from view to view. An aligned patch has unmodelled errors: the
// plane that faces the camera, and interpolation.
constexpr float kCornerSigma = 0.8f;
constexpr float kModelSigma = 0.15f;

float scale_of(const Keypoint& keypoint) {
  return kScaleOfOctave[keypoint.octave];
}

// d(current pixel) / d(reference pixel) for a plane through the point that faces the reference camera; full resolution.
Eigen::Matrix2f warp_between(const CameraView& reference, const CameraView& current,
                             const Eigen::Vector3d& point_in_world) {
  const double reference_depth = (reference.camera_from_world * point_in_world).z();
  const Eigen::Vector3d point_in_current = current.camera_from_world * point_in_world;
  const Eigen::Matrix3d current_from_reference =
      (current.camera_from_world.rotation * reference.camera_from_world.rotation.conjugate()).toRotationMatrix();
  const Eigen::Matrix<double, 2, 3> projection = current.rig.projection_jacobian(point_in_current).topRows<2>();
  const double metres_per_pixel = reference_depth / reference.rig.focal;
  return (projection * current_from_reference.leftCols<2>() * metres_per_pixel).cast<float>();
}

}  // namespace

PixelMeasurement corner_measurement(const Keypoint& keypoint) {
  return {keypoint.pixel, kCornerSigma * scale_of(keypoint), false};
}

float reference_sigma(const Features& features, int feature) {
  return (features.find_patch(feature) != nullptr ? kModelSigma : kCornerSigma) * scale_of(features.keypoint(feature));
}

PixelMeasurement measure_pixel(const ViewedFeature& reference, const Eigen::Vector3d& point_in_world,
                               const CameraView& current, int feature) {
  const Keypoint& keypoint = current.features.keypoint(feature);
  PixelMeasurement corner = corner_measurement(keypoint);
  const Patch* const patch = current.features.find_patch(feature);
  const Patch* const reference_patch = reference.view.features.find_patch(reference.feature);
  if (patch == nullptr || reference_patch == nullptr) return corner;
  corner.differs = true;

  const Keypoint& reference_keypoint = reference.view.features.keypoint(reference.feature);
  const float reference_scale = scale_of(reference_keypoint);
  const float scale = scale_of(keypoint);
  const Eigen::Matrix2f octave_warp = warp_between(reference.view, current, point_in_world) * (reference_scale / scale);
  const float magnification = octave_warp.determinant();
  if (!(magnification > 0.25f && magnification < 4.0f)) return corner;

  const Eigen::Vector2f reference_pixel =
      reference_patch->centre + (reference.pixel - reference_keypoint.pixel) / reference_scale;
  const auto alignment =
      align_patches(*reference_patch, reference_pixel, *patch, octave_warp.inverse(), patch->centre, {});
  if (!alignment) return corner;
  const float sigma = std::sqrt(alignment->sigma * alignment->sigma + kModelSigma * kModelSigma);
  return {keypoint.pixel + (alignment->pixel - patch->centre) * scale, sigma * scale, true};
}

}  // namespace byre
