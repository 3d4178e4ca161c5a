#pragma once

#include "byre/calibration.h"

#include <optional>
#include <vector>

namespace byre {

// The rays of a camera's pixels. Made once per camera, as undoing the distortion of the lens is slow.
class PixelRays {
 public:
  explicit PixelRays(const Camera& camera);

  int width() const { return width_; }
  int height() const { return height_; }

  // Directions in the camera's frame through a pixel's corners, which bound all rays that it collects: top left, top
  // right, bottom left, bottom right. Not of unit length: z = 1. Empty where the lens lets no light in.
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
  std::vector<Eigen::Vector3f> rays_;  // (width + 1) x (height + 1), row-major; NaN where there is none
};

}  // namespace byre
