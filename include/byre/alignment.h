#pragma once

#include "byre/pose.h"

#include <optional>
#include <span>

namespace byre {

// Transform with scale: point_in_target = rotation * (scale * point_in_source) + translation of target_from_source.
struct Similarity {
  double scale = 1.0;
  Pose target_from_source;

  Eigen::Vector3d operator*(const Eigen::Vector3d& point_in_source) const {
    return target_from_source * (scale * point_in_source);
  }
};

// Scales lengths: the translation of a pose, or the translation part of a small motion's covariance.
Pose scale_lengths(const Pose& pose, double scale);
Matrix6 scale_lengths(const Matrix6& covariance, double scale);

// Pose of a camera after the transform is applied to camera and scene together. Its image does not change; depths grow
// with the scale.
Pose move_camera(const Similarity& target_from_source, const Pose& camera_from_source);

enum class Scale { fixed, free };

// Least-squares fit of source onto target (Umeyama 1991, eq. 34 to 43). Empty if the points do not determine a
// transform: fewer than three, or collinear. Precondition: equal sizes.
std::optional<Similarity> align(std::span<const Eigen::Vector3d> points_in_source,
                                std::span<const Eigen::Vector3d> points_in_target, Scale scale);

}  // namespace byre
