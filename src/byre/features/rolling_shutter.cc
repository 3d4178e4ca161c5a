#include "byre/features/rolling_shutter.h"

#include "byre/base/scratch_memory.h"
#include "byre/features/image_bounds.h"

#include <utility>

namespace byre {
namespace {

Keypoint correct_rolling_shutter(Keypoint keypoint, const Rig& rig, const CameraMotion& motion, double readout_time) {
  const double depth = keypoint.has_disparity() ? rig.focal * rig.baseline / keypoint.disparity : motion.depth;
  const Pose middle_from_row = exp_pose(motion.velocity * (-readout_time * keypoint.row_time));
  const Eigen::Vector3d point = middle_from_row * Eigen::Vector3d(depth * rig.ray(keypoint.pixel.cast<double>()));
  if (point.z() <= 0.0) return keypoint;
  const StereoPixel pixel = rig.project(point);
  keypoint.pixel = nearest_in_image(pixel.head<2>(), rig);
  if (keypoint.has_disparity()) keypoint.disparity = static_cast<float>(pixel.z());
  return keypoint;
}

}  // namespace

Features correct_rolling_shutter(const Features& features, const Rig& rig, const CameraMotion& motion,
                                 double readout_time) {
  std::vector<Keypoint> keypoints = to_vector(features.keypoints());
  for (Keypoint& keypoint : keypoints) keypoint = correct_rolling_shutter(keypoint, rig, motion, readout_time);
  return features.moved(std::move(keypoints));
}

void correct_rolling_shutter(const Features& features, const Rig& rig, const CameraMotion& motion, double readout_time,
                             Features& result) {
  ScratchVector<Keypoint> keypoints(features.keypoints().begin(), features.keypoints().end());
  for (Keypoint& keypoint : keypoints) keypoint = correct_rolling_shutter(keypoint, rig, motion, readout_time);
  result.refill_moved(features, keypoints);
}

}  // namespace byre
