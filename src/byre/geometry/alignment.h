#pragma once

#include "byre/geometry/pose.h"

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

enum class Scale { fixed, free };

// Least-squares fit of source onto target (Umeyama 1991, eq. 34 to 43). Empty when the points do not
// determine a transform: fewer than three, or all on one line. Precondition: equal sizes.
std::optional<Similarity> align(std::span<const Eigen::Vector3d> points_in_source,
                                std::span<const Eigen::Vector3d> points_in_target, Scale scale);

}  // namespace byre
