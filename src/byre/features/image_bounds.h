#pragma once

#include "byre/rig.h"

namespace byre {

// Clamps a pixel to the image, because features must lie inside it.
inline Eigen::Vector2f nearest_in_image(const Eigen::Vector2d& pixel, const Rig& rig) {
  const Eigen::Vector2f last(static_cast<float>(rig.width - 1), static_cast<float>(rig.height - 1));
  return pixel.cast<float>().cwiseMax(0.0f).cwiseMin(last);
}

}  // namespace byre
