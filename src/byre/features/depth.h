#pragma once

#include "byre/calibration.h"
#include "byre/features.h"
#include "byre/image.h"
#include "byre/rig.h"

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace byre {

struct DepthOptions {
  double max_depth = 10.0;    // metres
  double misalignment = 1.0;  // depth-to-colour misregistration, pixels
};

// Depth at a keypoint, as the disparity of the rig's virtual stereo pair.
struct DepthReading {
  float disparity = 0.0f;  // pixels
  float sigma = 0.0f;      // pixels
};

// Samples a depth image at keypoints.
class DepthReader {
 public:
  // rig: the rig to which the images of the calibration are rectified. Precondition: the calibration has a depth
  // camera.
  DepthReader(const Calibration& calibration, const Rig& rig);

  // One entry per keypoint; empty without depth, or if the surrounding depths disagree. At the edge of a surface the
  // nearer one is used. Precondition: the image has the size of the depth camera's.
  std::vector<std::optional<DepthReading>> read(const DepthImage& image, const std::vector<Keypoint>& keypoints,
                                                const DepthOptions& options) const;

 private:
  // Metres, for each pixel of the original left image; zero without depth.
  std::vector<float> depths_in_left(const DepthImage& image) const;
  std::vector<float> warped_to_left(const DepthImage& image) const;

  // Constant after construction.
  Camera left_;
  DepthCamera depth_camera_;
  Rig rig_;
  // Rays of the depth camera's pixels, z = 1; empty for registered depth images.
  std::vector<Eigen::Vector3d> rays_;
};

}  // namespace byre
