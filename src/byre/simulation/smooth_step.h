#pragma once

namespace byre {

// From 0 at 0 to 1 at 1, level at both (Hermite).
inline float smooth_step(float x) {
  return x * x * (3.0f - 2.0f * x);
}

}  // namespace byre
