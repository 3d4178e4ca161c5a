#pragma once

#include "byre/pose.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace byre {

// Lens models as EuRoC, Kalibr and OpenCV define them.
// radial_tangential: k1, k2, p1, p2, k3 (Brown-Conrady); equidistant: k1..k4 (Kannala-Brandt fisheye).
enum class CameraModel : std::uint8_t { pinhole, radial_tangential, equidistant };

std::string_view to_string(CameraModel model);

// A camera as calibrated. Pixels: origin at the centre of the top-left pixel, u right, v down.
struct Camera {
  CameraModel model = CameraModel::pinhole;
  int width = 0;                                  // pixels
  int height = 0;                                 // pixels
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  // pixels
  std::array<double, 5> distortion{};             // see CameraModel, unused ones zero

  // The pixel of a point, also outside the image; empty behind the camera or beyond the model's valid field.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_in_camera) const;

  // Unit direction of a pixel; inverts the distortion by Newton's method. Empty where it has no inverse.
  std::optional<Eigen::Vector3d> bearing(const Eigen::Vector2d& pixel) const;

  bool contains(const Eigen::Vector2d& pixel) const;  // inside the image, borders included

  bool operator==(const Camera&) const = default;
};

struct StereoPartner {
  Camera camera;
  Pose right_from_left;

  bool operator==(const StereoPartner&) const = default;
};

// A camera beside the left one whose images hold depths along its optical axis.
struct DepthCamera {
  std::optional<Camera> camera{};      // empty where its images are registered: pixel by pixel those of the left camera
  Pose left_from_depth{};              // identity where its images are registered
  double units_per_metre = 5000.0;     // numbers in the depth images per metre
  double sigma_at_one_metre = 0.0025;  // standard error of a depth of one metre, metres; grows with the square of depth
  double baseline = 0.08;              // metres: depths are told as disparities of a pair this far apart

  bool operator==(const DepthCamera&) const = default;
};

// What a recording says of its cameras, before any rectification. Of right and depth camera there is one at most.
struct Calibration {
  Camera left;
  std::optional<StereoPartner> right;
  Pose body_from_left;  // identity where the recording knows no body
  std::optional<DepthCamera> depth{};
  // Seconds in which a rolling shutter reads the rows of an image, the first one first (negative: the last one first);
  // a time stamp is the middle row's. Zero: all rows are exposed at once.
  double readout_time = 0.0;

  bool tells_metres() const { return right.has_value() || depth.has_value(); }

  // Equality of every number, to the last digit.
  bool operator==(const Calibration&) const = default;
};

}  // namespace byre
