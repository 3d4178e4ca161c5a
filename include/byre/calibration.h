#pragma once

#include "byre/pose.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace byre {

// Lens models as defined by EuRoC, Kalibr, OpenCV and COLMAP. Distortion coefficients:
//   radial_tangential   k1, k2, p1, p2, k3 (Brown-Conrady)
//   equidistant         k1 to k4 (Kannala-Brandt fisheye)
//   rational            k1, k2, p1, p2, k3 to k6, s1 to s4, tx, ty (OpenCV, with thin prism and tilted sensor)
//   unified             k1, k2, p1, p2, xi (omni, Mei)
//   extended_unified    k1, k2, p1, p2, alpha, beta (Khomutenko)
//   double_sphere       k1, k2, p1, p2, xi, alpha (Usenko)
//   field_of_view       k1, k2, p1, p2, omega (Devernay)
//   thin_prism_fisheye  k1, k2, p1, p2, k3, k4, s1, s3 on the equidistant plane (COLMAP)
enum class CameraModel : std::uint8_t {
  pinhole,
  radial_tangential,
  equidistant,
  rational,
  unified,
  extended_unified,
  double_sphere,
  field_of_view,
  thin_prism_fisheye
};

inline constexpr int kCameraModels = 9;

std::string_view to_string(CameraModel model);

// Intrinsics of a camera. Pixels: origin at the centre of the top-left pixel, u right, v down.
struct Camera {
  CameraModel model = CameraModel::pinhole;
  int width = 0;                                  // pixels
  int height = 0;                                 // pixels
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  // pixels
  std::array<double, 14> distortion{};            // see CameraModel; unused ones are zero

  // Pixel of a point, also outside the image. Empty behind the camera or beyond the model's valid field.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_in_camera) const;

  // Unit direction of a pixel in the camera frame, by Newton's method. Empty if the distortion has no inverse there.
  std::optional<Eigen::Vector3d> bearing(const Eigen::Vector2d& pixel) const;

  bool contains(const Eigen::Vector2d& pixel) const;  // inside the image, borders included

  bool operator==(const Camera&) const = default;
};

// Right camera of a stereo pair.
struct StereoPartner {
  Camera camera;
  Pose right_from_left;

  bool operator==(const StereoPartner&) const = default;
};

// Depth camera next to the left camera. Its images hold depths along its optical axis.
struct DepthCamera {
  std::optional<Camera> camera{};      // empty if its images are registered to the left camera's pixels
  Pose left_from_depth{};              // identity if its images are registered
  double units_per_metre = 5000.0;     // units of the depth images per metre
  double sigma_at_one_metre = 0.0025;  // standard deviation at one metre, metres; grows with the square of depth
  double baseline = 0.08;              // metres, of the virtual stereo pair whose disparities represent the depths

  bool operator==(const DepthCamera&) const = default;
};

// Cameras of a recording before rectification: one camera, a stereo pair, or a camera with a depth camera.
struct Calibration {
  Camera left;
  std::optional<StereoPartner> right;
  Pose body_from_left;  // identity if the recording has no body frame
  std::optional<DepthCamera> depth{};
  // Rolling-shutter readout time from the first row to the last, seconds; negative if the last row is read first. A
  // time stamp refers to the middle row. Zero: global shutter.
  double readout_time = 0.0;

  // Whether these cameras alone determine metric scale.
  bool is_metric() const { return right.has_value() || depth.has_value(); }

  // Exact equality of all numbers.
  bool operator==(const Calibration&) const = default;
};

}  // namespace byre
