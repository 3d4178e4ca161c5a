#pragma once

#include "byre/calibration.h"

#include <optional>
#include <vector>

namespace byre {

// The camera after binning of divisor x divisor pixels; remaining columns and rows at the right and bottom are cut off.
Camera downscaled_camera(Camera camera, int divisor);

// The camera with another image size, in pixels. The horizontal field of view is kept; the vertical one is cropped or
// extended equally above and below.
Camera resized_camera(Camera camera, int width, int height);

// Rays of a camera's pixels. Construction is slow (undistortion); construct once per camera.
class PixelRays {
 public:
  explicit PixelRays(const Camera& camera);

  int width() const { return width_; }
  int height() const { return height_; }

  // Rays through a pixel's four corners in the camera frame, with z = 1; they bound all light of the pixel. Empty
  // outside the lens's field of view.
  struct Corners {
    Eigen::Vector3f top_left, top_right, bottom_left, bottom_right;

    // x and y from 0 to 1 across the pixel.
    Eigen::Vector3f at(float x, float y) const {
      return (1.0f - y) * ((1.0f - x) * top_left + x * top_right) + y * ((1.0f - x) * bottom_left + x * bottom_right);
    }
  };
  std::optional<Corners> corners(int column, int row) const;

 private:
  int width_;
  int height_;
  std::vector<Eigen::Vector3f> rays_;  // (width + 1) x (height + 1), row-major; NaN outside the field of view
};

}  // namespace byre
