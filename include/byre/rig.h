#pragma once

#include "byre/pose.h"

#include <Eigen/Core>

namespace byre {

// Observation of a point by a rectified stereo pair, pixels: left column, row (equal in both images), and disparity
// (left minus right column). Monocular observations have no disparity, see Rig::is_stereo.
using StereoPixel = Eigen::Vector3d;
using StereoJacobian = Eigen::Matrix3d;

// Ideal camera of all features: rectified, undistorted, one focal length, rows aligned. Camera frame: x right, y down,
// z forward, origin at the left camera.
struct Rig {
  int width = 0;              // pixels
  int height = 0;             // pixels
  double focal = 0.0;         // pixels
  double cx = 0.0;            // pixels, the same in both images
  double cy = 0.0;            // pixels, equal in both images
  double baseline = 0.0;      // metres; zero for a monocular rig; of a virtual pair for a depth camera
  Pose body_from_camera;      // identity if the recording has no body frame
  double readout_time = 0.0;  // seconds, of the source images; see Calibration

  bool is_stereo() const { return baseline > 0.0; }

  // Image of a point. Precondition: point_in_camera.z() > 0.
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

  // Inverse of project(): point in the camera frame. Preconditions: is_stereo() and pixel.z() > 0.
  Eigen::Vector3d triangulate(const StereoPixel& pixel) const {
    const double depth = focal * baseline / pixel.z();
    return depth * ray(pixel.head<2>());
  }

  // Direction of a pixel in the camera frame, with z = 1.
  Eigen::Vector3d ray(const Eigen::Vector2d& pixel) const {
    return {(pixel.x() - cx) / focal, (pixel.y() - cy) / focal, 1.0};
  }

  // Whether a pixel lies at least border pixels inside the image.
  bool contains(const Eigen::Vector2d& pixel, double border = 0.0) const {
    return pixel.x() >= border && pixel.y() >= border && pixel.x() <= width - 1 - border &&
           pixel.y() <= height - 1 - border;
  }
};

}  // namespace byre
