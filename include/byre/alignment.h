#pragma once

#include "byre/pose.h"

#include <optional>
#include <span>

namespace byre {

// point_in_target = target_from_source.rotation * (scale * point_in_source) + target_from_source.translation
struct Similarity {
  double scale = 1.0;
  Pose target_from_source;

  Eigen::Vector3d operator*(const Eigen::Vector3d& point_in_source) const {
    return target_from_source * (scale * point_in_source);
  }
};

// A pose, or the covariance of a small motion, with all lengths times the scale.
Pose scale_lengths(const Pose& pose, double scale);
Matrix6 scale_lengths(const Matrix6& covariance, double scale);

// Where a camera lies that goes along with all it sees: the image stays the same, and depths grow with the scale.
Pose move_camera(const Similarity& target_from_source, const Pose& camera_from_source);

enum class Scale { fixed, free };

// Least-squares fit of source onto target (Umeyama 1991, eq. 34 to 43). Empty when the points do not
// determine a transform: fewer than three, or all on one line. Precondition: equal sizes.
std::optional<Similarity> align(std::span<const Eigen::Vector3d> points_in_source,
                                std::span<const Eigen::Vector3d> points_in_target, Scale scale);

}  // namespace byre
