#include "byre/features/rectify.h"

#include "byre/geometry/rectification.h"

namespace byre {

cv::Mat Rectifier::Side::apply(const cv::Mat& image) const {
  if (remap.empty()) return image;
  remap.apply(image, rectified);
  return rectified;
}

Remap Rectifier::make_remap(const Camera& camera, const Eigen::Quaterniond& camera_from_rectified, const Rig& rig) {
  cv::Mat columns(rig.height, rig.width, CV_32F);
  cv::Mat rows(rig.height, rig.width, CV_32F);
  for (int v = 0; v < rig.height; ++v) {
    for (int u = 0; u < rig.width; ++u) {
      const auto pixel = camera.project(camera_from_rectified * rig.ray({u, v}));
      columns.at<float>(v, u) = pixel ? static_cast<float>(pixel->x()) : -1.0f;
      rows.at<float>(v, u) = pixel ? static_cast<float>(pixel->y()) : -1.0f;
    }
  }
  return Remap(columns, rows, {camera.width, camera.height});
}

Rectifier::Rectifier(const Calibration& calibration) {
  const Rectification rectification = rectification_of(calibration);
  rig_ = rectification.rig;
  if (rectification.is_identity) return;
  left_.remap = make_remap(calibration.left, rectification.left_from_rectified, rig_);
  if (!calibration.right) return;
  right_.remap = make_remap(calibration.right->camera, rectification.right_from_rectified, rig_);
}

float Rectifier::source_row(const Eigen::Vector2f& rectified) const {
  if (left_.remap.empty()) return rectified.y();
  return static_cast<float>(left_.remap.source_row({static_cast<int>(rectified.x()), static_cast<int>(rectified.y())}));
}

}  // namespace byre
