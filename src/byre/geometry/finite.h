#pragma once

#include "byre/pose.h"

namespace byre {

inline bool is_finite(const Pose& pose) {
  return pose.translation.allFinite() && pose.rotation.coeffs().allFinite();
}

}  // namespace byre
