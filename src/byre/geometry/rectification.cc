#include "byre/geometry/rectification.h"

#include "byre/input_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

struct View {
  const Camera* camera;
  Eigen::Quaterniond rectified_from_camera;
};

// Part of the plane z = 1 of the rectified camera.
struct Field {
  double left = -std::numeric_limits<double>::infinity();
  double right = std::numeric_limits<double>::infinity();
  double top = -std::numeric_limits<double>::infinity();
  double bottom = std::numeric_limits<double>::infinity();
};

// A border pixel on the plane z = 1. If the lens model cannot invert it or it lies to the side of the rectified camera:
// the outermost valid pixel on the line to the principal point.
Eigen::Vector2d on_rectified_plane(const View& view, const Eigen::Vector2d& border) {
  constexpr double kMinForward = 0.1;  // cosine of the angle off the rectified axis
  const Eigen::Vector2d centre(view.camera->cx, view.camera->cy);
  bool invertible = false;
  for (double fraction = 1.0; fraction > 0.1; fraction -= 0.02) {
    const auto bearing = view.camera->bearing(centre + fraction * (border - centre));
    if (!bearing) continue;
    invertible = true;
    const Eigen::Vector3d ray = view.rectified_from_camera * *bearing;
    if (ray.z() > kMinForward) return ray.head<2>() / ray.z();
  }
  if (invertible) {
    throw InputError("calibration", "the optical axes differ too much for rectification",
                     "check the extrinsic calibration of the pair");
  }
  throw InputError("calibration", "the distortion cannot be inverted near the image centre",
                   "check intrinsics and distortion coefficients");
}

// Quarter turns of the camera's image that bring it nearest to the rectified one.
int quarter_turns(const View& view) {
  const Eigen::Vector3d right = view.rectified_from_camera * Eigen::Vector3d::UnitX();
  const auto turns = static_cast<int>(std::lround(std::atan2(right.y(), right.x()) / (0.5 * std::numbers::pi)));
  return (turns + 4) % 4;
}

// Shrinks the field to the largest upright rectangle inside this view's field.
void clip_to_view(const View& view, Field& field) {
  const double last_u = view.camera->width - 1;
  const double last_v = view.camera->height - 1;
  constexpr int kSamples = 32;
  const int turns = quarter_turns(view);
  for (int i = 0; i <= kSamples; ++i) {
    const double u = last_u * i / kSamples;
    const double v = last_v * i / kSamples;
    // Sides of the image in clockwise order; the first of the rectified image is the left one.
    const std::array<Eigen::Vector2d, 4> sides = {Eigen::Vector2d(0.0, v), Eigen::Vector2d(u, 0.0),
                                                  Eigen::Vector2d(last_u, v), Eigen::Vector2d(u, last_v)};
    const auto side = [&](int number) {
      return on_rectified_plane(view, sides[static_cast<std::size_t>((number + 4 - turns) % 4)]);
    };
    field.left = std::max(field.left, side(0).x());
    field.right = std::min(field.right, side(2).x());
    field.top = std::max(field.top, side(1).y());
    field.bottom = std::min(field.bottom, side(3).y());
  }
}

// Rotates both images so that rows are parallel to the baseline and the view is along the mean optical axis.
Eigen::Quaterniond rectified_from_left(const StereoPartner& partner) {
  const Pose left_from_right = inverse(partner.right_from_left);
  const Eigen::Vector3d x_axis = left_from_right.translation.normalized();
  constexpr double kLeastShare = 0.5;  // least share of the baseline along a side of the image
  if (!(left_from_right.translation.norm() > 1e-6) || x_axis.x() < -kLeastShare) {
    throw InputError("calibration", "the right camera is not to the right of the left camera",
                     "exchange left and right, also where both cameras are upside down; or check the sign of the "
                     "extrinsic calibration: left and right may be swapped");
  }
  if (x_axis.x() < kLeastShare && std::abs(x_axis.y()) < kLeastShare) {
    throw InputError("calibration", "the right camera is in front of the left camera or behind it",
                     "check the extrinsic calibration: its translation has the axes x right, y down, z forward");
  }
  const Eigen::Vector3d mean_axis = Eigen::Vector3d::UnitZ() + left_from_right.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d z_axis = (mean_axis - mean_axis.dot(x_axis) * x_axis).normalized();
  Eigen::Matrix3d rotation;
  rotation << x_axis.transpose(), z_axis.cross(x_axis).transpose(), z_axis.transpose();
  return Eigen::Quaterniond(rotation);
}

bool is_ideal(const Camera& camera) {
  return camera.model == CameraModel::pinhole && camera.fx == camera.fy;
}

bool is_rectified(const Calibration& calibration) {
  if (!is_ideal(calibration.left)) return false;
  if (!calibration.right) return true;
  const Camera& left = calibration.left;
  const Camera& right = calibration.right->camera;
  const Pose& right_from_left = calibration.right->right_from_left;
  return is_ideal(right) && left.width == right.width && left.height == right.height && left.fx == right.fx &&
         left.cx == right.cx && left.cy == right.cy && right_from_left.rotation.vec().norm() < 1e-12 &&
         right_from_left.translation.tail<2>().norm() < 1e-9 && right_from_left.translation.x() < 0.0;
}

double disparity_baseline(const Calibration& calibration) {
  if (calibration.right) return calibration.right->right_from_left.translation.norm();
  return calibration.depth ? calibration.depth->baseline : 0.0;
}

// The value in [low, high] nearest to zero. Not std::clamp: rounding may swap nearly equal bounds.
double nearest_to_axis(double low, double high) {
  return std::min(std::max(0.0, low), high);
}

// The camera that shows exactly the whole field at the source's resolution. A turn by a quarter exchanges the sides.
Rig rig_of_field(const Field& field, Camera source, bool is_turned_by_quarter) {
  if (is_turned_by_quarter) {
    std::swap(source.width, source.height);
    std::swap(source.fx, source.fy);
  }
  const double width = field.right - field.left;
  const double height = field.bottom - field.top;
  if (!(width > 0.0) || !(height > 0.0)) {
    throw InputError("calibration", "the fields of view of the cameras do not overlap",
                     "check the extrinsic calibration of the pair");
  }
  // Very wide lenses are cropped: the resolution is at most this factor below that of the source's centre.
  constexpr double kMaxShrink = 2.0;
  const double filling = std::max((source.width - 1) / width, (source.height - 1) / height);
  Rig rig;
  rig.width = source.width;
  rig.height = source.height;
  rig.focal = std::max(filling, 0.5 * (source.fx + source.fy) / kMaxShrink);
  // A field larger than the image is cropped to the part nearest to the axis.
  const double half_width = 0.5 * (rig.width - 1);
  const double half_height = 0.5 * (rig.height - 1);
  const double middle_x = nearest_to_axis(field.left + half_width / rig.focal, field.right - half_width / rig.focal);
  const double middle_y = nearest_to_axis(field.top + half_height / rig.focal, field.bottom - half_height / rig.focal);
  rig.cx = half_width - rig.focal * middle_x;
  rig.cy = half_height - rig.focal * middle_y;
  return rig;
}

}  // namespace

Rectification rectification_of(const Calibration& calibration) {
  const Camera& left = calibration.left;
  const double baseline = disparity_baseline(calibration);
  constexpr double kMost = 10.0;  // metres; also limits a baseline that a user confirms
  if (baseline > kMost) {
    throw InputError("calibration", fmt::format("has a baseline of {:g} m", baseline),
                     "give the extrinsic calibration in metres");
  }
  Rectification result;
  if (is_rectified(calibration)) {
    result.rig = {left.width,
                  left.height,
                  left.fx,
                  left.cx,
                  left.cy,
                  baseline,
                  calibration.body_from_left,
                  calibration.readout_time};
    result.is_identity = true;
    return result;
  }
  const Eigen::Quaterniond turned_left =
      calibration.right ? rectified_from_left(*calibration.right) : Eigen::Quaterniond::Identity();
  Field field;
  clip_to_view({&left, turned_left}, field);
  Eigen::Quaterniond turned_right = turned_left;
  if (calibration.right) {
    turned_right = turned_left * calibration.right->right_from_left.rotation.conjugate();
    clip_to_view({&calibration.right->camera, turned_right}, field);
  }
  const bool is_turned_by_quarter = quarter_turns({&left, turned_left}) % 2 == 1;
  if (is_turned_by_quarter && calibration.readout_time != 0.0) {
    throw InputError("calibration", "has a rolling shutter, and one camera above the other",
                     "a vertical pair needs a global shutter; use the left camera alone");
  }
  result.rig = rig_of_field(field, left, is_turned_by_quarter);
  result.rig.baseline = baseline;
  result.rig.readout_time = calibration.readout_time;
  result.rig.body_from_camera = calibration.body_from_left * Pose{turned_left.conjugate(), Eigen::Vector3d::Zero()};
  result.left_from_rectified = turned_left.conjugate();
  result.right_from_rectified = turned_right.conjugate();
  return result;
}

bool can_be_rectified(const Calibration& calibration) {
  try {
    rectification_of(calibration);
  } catch (const InputError&) {
    return false;
  }
  return true;
}

}  // namespace byre
