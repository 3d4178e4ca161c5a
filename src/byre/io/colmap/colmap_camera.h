#pragma once

#include "byre/calibration.h"
#include "byre/io/colmap/colmap_model.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace byre {

// A camera model of COLMAP 3.8, supported by byre or not.
struct ColmapCameraModel {
  std::int32_t id = 0;  // number of the model in binary files
  std::string_view name;
  std::size_t parameters = 0;  // number of parameters
};

const ColmapCameraModel* find_colmap_camera_model(std::int32_t id);        // nullptr if there is none
const ColmapCameraModel* find_colmap_camera_model(std::string_view name);  // nullptr if there is none

// Converts SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, OPENCV_FISHEYE, and FULL_OPENCV without k4 to k6.
// Throws InputError with the place for any other model, and for invalid sizes, focal lengths and principal points.
Camera camera_of(const ColmapCamera& camera, const std::string& place);

// PINHOLE, OPENCV, OPENCV_FISHEYE, or FULL_OPENCV if k3 is not zero.
ColmapCamera colmap_camera(const Camera& camera);

// Converts byre's pixels to COLMAP's: the centre of the top-left pixel is (0, 0) and (0.5, 0.5).
inline Eigen::Vector2d to_colmap_pixel(const Eigen::Vector2d& pixel) {
  return pixel + Eigen::Vector2d::Constant(0.5);
}

}  // namespace byre
