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
  double misalignment = 1.0;  // pixels by which depths may lie beside what they are of
};

// What a depth image says of a keypoint, in terms of the rig's imagined pair.
struct DepthReading {
  float disparity = 0.0f;  // pixels
  float sigma = 0.0f;      // pixels
};

// Reads depths where keypoints are.
class DepthReader {
 public:
  // The rig is what the calibration's images are rectified to. Precondition: the calibration has a depth camera.
  DepthReader(const Calibration& calibration, const Rig& rig);

  // One entry per keypoint, empty where there is no depth, or none that its surroundings agree on. At the edge of a
  // surface it is the nearer one's. Precondition: the image has the size of the depth camera's.
  std::vector<std::optional<DepthReading>> read(const DepthImage& image, const std::vector<Keypoint>& keypoints,
                                                const DepthOptions& options) const;

 private:
  // Metres, pixel by pixel of the left image as it was taken; zero where there is none.
  std::vector<float> depths_in_left(const DepthImage& image) const;
  std::vector<float> warped_to_left(const DepthImage& image) const;

  // Constant after construction.
  Camera left_;
  DepthCamera depth_camera_;
  Rig rig_;
  // Rays of the depth camera's pixels, z = 1; empty where its images are registered.
  std::vector<Eigen::Vector3d> rays_;
};

}  // namespace byre
