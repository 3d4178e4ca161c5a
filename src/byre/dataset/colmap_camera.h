#pragma once

#include "byre/calibration.h"
#include "byre/dataset/colmap_model.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace byre {

// A camera model of COLMAP 3.8, whether byre can use it or not.
struct ColmapCameraKind {
  std::int32_t id = 0;  // number of the model in binary files
  std::string_view name;
  std::size_t parameters = 0;  // how many
};

const ColmapCameraKind* find_colmap_camera_kind(std::int32_t id);        // nullptr when there is none
const ColmapCameraKind* find_colmap_camera_kind(std::string_view name);  // nullptr when there is none

// SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, OPENCV_FISHEYE, and FULL_OPENCV without k4 to k6, as byre's
// camera. Throws InputError, naming the place, on any other model and on sizes, focal lengths and principal points that
// make no sense.
Camera camera_of(const ColmapCamera& camera, const std::string& place);

// PINHOLE, OPENCV, OPENCV_FISHEYE, or FULL_OPENCV where there is a k3.
ColmapCamera colmap_camera(const Camera& camera);

// From byre's pixels to COLMAP's: (0, 0) and (0.5, 0.5) are the centre of the top-left pixel.
inline Eigen::Vector2d to_colmap_pixel(const Eigen::Vector2d& pixel) {
  return pixel + Eigen::Vector2d::Constant(0.5);
}

}  // namespace byre
