#pragma once

namespace byre {

// Hermite step from 0 at 0 to 1 at 1, with zero slope at both ends.
inline float smooth_step(float x) {
  return x * x * (3.0f - 2.0f * x);
}

}  // namespace byre
