#include "byre/features/recalibrated.h"

#include "byre/base/scratch_memory.h"
#include "byre/features/image_bounds.h"

namespace byre {
namespace {

Keypoint recalibrated(Keypoint keypoint, const RectifiedChange& change) {
  const RectifiedChange::Corner corner =
      change({{keypoint.pixel.x(), keypoint.pixel.y(), keypoint.disparity}, keypoint.row_offset});
  keypoint.pixel = nearest_in_image(corner.pixel.head<2>(), change.rig());
  if (!keypoint.has_disparity()) return keypoint;
  keypoint.row_offset = static_cast<float>(corner.row_offset);
  keypoint.disparity = static_cast<float>(corner.pixel.z());
  if (keypoint.disparity > 0.0f) return keypoint;
  keypoint.disparity = keypoint.disparity_sigma = -1.0f;  // no depth: beyond infinity
  return keypoint;
}

}  // namespace

Features recalibrated(const Features& features, const RectifiedChange& change) {
  std::vector<Keypoint> keypoints = to_vector(features.keypoints());
  for (Keypoint& keypoint : keypoints) keypoint = recalibrated(keypoint, change);
  return features.moved(std::move(keypoints));
}

void recalibrate_into(const Features& features, const RectifiedChange& change, Features& result) {
  ScratchVector<Keypoint> keypoints(features.keypoints().begin(), features.keypoints().end());
  for (Keypoint& keypoint : keypoints) keypoint = recalibrated(keypoint, change);
  result.refill_moved(features, keypoints);
}

void recalibrate_tags(std::vector<TagSighting>& tags, const RectifiedChange& change) {
  for (TagSighting& tag : tags) {
    for (Eigen::Vector2d& corner : tag.corners) corner = change({{corner.x(), corner.y(), -1.0}, 0.0}).pixel.head<2>();
  }
}

Eigen::Vector2f recalibrated(const Eigen::Vector2f& pixel, const RectifiedChange& change) {
  return change({{pixel.x(), pixel.y(), -1.0}, 0.0}).pixel.head<2>().cast<float>();
}

}  // namespace byre
