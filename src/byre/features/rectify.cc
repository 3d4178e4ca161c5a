#include "byre/features/rectify.h"

#include "byre/geometry/rectification.h"

#include <opencv2/imgproc.hpp>

namespace byre {

cv::Mat Rectifier::Maps::apply(const cv::Mat& image) const {
  if (whole.empty()) return image;
  cv::remap(image, rectified, whole, fraction, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return rectified;
}

Rectifier::Maps Rectifier::make_maps(const Camera& camera, const Eigen::Quaterniond& camera_from_rectified,
                                     const Rig& rig) {
  cv::Mat columns(rig.height, rig.width, CV_32F);
  cv::Mat rows(rig.height, rig.width, CV_32F);
  for (int v = 0; v < rig.height; ++v) {
    for (int u = 0; u < rig.width; ++u) {
      const auto pixel = camera.project(camera_from_rectified * rig.ray({u, v}));
      columns.at<float>(v, u) = pixel ? static_cast<float>(pixel->x()) : -1.0f;
      rows.at<float>(v, u) = pixel ? static_cast<float>(pixel->y()) : -1.0f;
    }
  }
  Maps maps;
  cv::convertMaps(columns, rows, maps.whole, maps.fraction, CV_16SC2);
  return maps;
}

Rectifier::Rectifier(const Calibration& calibration) {
  const Rectification rectification = rectification_of(calibration);
  rig_ = rectification.rig;
  if (rectification.is_identity) return;
  left_ = make_maps(calibration.left, rectification.left_from_rectified, rig_);
  if (calibration.right) right_ = make_maps(calibration.right->camera, rectification.right_from_rectified, rig_);
}

float Rectifier::source_row(const Eigen::Vector2f& rectified) const {
  if (left_.whole.empty()) return rectified.y();
  const auto row = static_cast<int>(rectified.y()), column = static_cast<int>(rectified.x());
  return left_.whole.at<cv::Vec2s>(row, column)[1];
}

}  // namespace byre
