#pragma once

#include "byre/pose.h"

#include <optional>

#include <Eigen/Core>

namespace byre {

// Where a rectified stereo pair sees a point: left column, row (equal in both images), and disparity,
// the left minus the right column. Pixels. A monocular sighting has no disparity; see Rig::is_stereo.
using StereoPixel = Eigen::Vector3d;
using StereoJacobian = Eigen::Matrix3d;

// The ideal camera that features live in: rectified, without distortion, one focal length, rows aligned.
// Camera frame: x right, y down, z forward, at the left camera.
struct Rig {
  int width = 0;              // pixels
  int height = 0;             // pixels
  double focal = 0.0;         // pixels
  double cx = 0.0;            // pixels, the same in both images
  double cy = 0.0;            // pixels
  double baseline = 0.0;      // metres, zero for a monocular rig; with a depth camera that of an imagined pair
  Pose body_from_camera;      // identity where the recording knows no body
  double readout_time = 0.0;  // seconds, of the images it is made from, see Calibration

  bool is_stereo() const { return baseline > 0.0; }

  // Precondition: point_in_camera.z() > 0.
  StereoPixel project(const Eigen::Vector3d& point_in_camera) const {
    const double inverse_depth = 1.0 / point_in_camera.z();
    return {focal * point_in_camera.x() * inverse_depth + cx, focal * point_in_camera.y() * inverse_depth + cy,
            focal * baseline * inverse_depth};
  }

  // d(u, v, disparity) / d(point_in_camera).
  StereoJacobian projection_jacobian(const Eigen::Vector3d& point_in_camera) const {
    const double inverse_depth = 1.0 / point_in_camera.z();
    const double scale = focal * inverse_depth;
    StereoJacobian jacobian;
    jacobian << scale, 0.0, -scale * point_in_camera.x() * inverse_depth,  //
        0.0, scale, -scale * point_in_camera.y() * inverse_depth,          //
        0.0, 0.0, -scale * baseline * inverse_depth;
    return jacobian;
  }

  // Inverse of project. Precondition: is_stereo() and pixel.z() > 0.
  Eigen::Vector3d triangulate(const StereoPixel& pixel) const {
    const double depth = focal * baseline / pixel.z();
    return depth * ray(pixel.head<2>());
  }

  // The direction of a pixel with z = 1.
  Eigen::Vector3d ray(const Eigen::Vector2d& pixel) const {
    return {(pixel.x() - cx) / focal, (pixel.y() - cy) / focal, 1.0};
  }

  bool contains(const Eigen::Vector2d& pixel, double border = 0.0) const {
    return pixel.x() >= border && pixel.y() >= border && pixel.x() <= width - 1 - border &&
           pixel.y() <= height - 1 - border;
  }
};

}  // namespace byre
