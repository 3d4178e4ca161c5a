#pragma once

#include "byre/simulation/surface_texture.h"

#include <cstdint>

namespace byre {

// Random numbers determined by a seed alone, identical for every compiler.
class SeededDraws {
 public:
  // stream: purpose of the numbers; streams of one seed are independent.
  SeededDraws(std::uint64_t seed, std::uint64_t stream) : seed_(hash(seed, stream, 0)) {}

  std::uint64_t bits() { return hash(seed_, ++count_, 0); }

  // Uniform in [low, high).
  float between(float low, float high) {
    constexpr float kStep = 1.0f / 16777216.0f;  // step of a float's 24 bits
    return low + (high - low) * kStep * static_cast<float>(bits() >> 40);
  }

  int below(int count) { return static_cast<int>(bits() % static_cast<std::uint64_t>(count)); }  // 0 to count - 1

 private:
  std::uint64_t seed_;
  std::uint64_t count_ = 0;
};

}  // namespace byre
