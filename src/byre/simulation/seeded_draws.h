#pragma once

#include "byre/simulation/surface_texture.h"

#include <cstdint>

namespace byre {

// Random numbers that follow from a seed alone, the same with every compiler.
class SeededDraws {
 public:
  // stream: what the numbers are for; other streams of the same seed are independent.
  SeededDraws(std::uint64_t seed, std::uint64_t stream) : seed_(hash(seed, stream, 0)) {}

  std::uint64_t bits() { return hash(seed_, ++count_, 0); }

  // Uniform in [low, high).
  float between(float low, float high) {
    constexpr float kStep = 1.0f / 16777216.0f;  // step of 24 bits, as many as a float has
    return low + (high - low) * kStep * static_cast<float>(bits() >> 40);
  }

  int below(int count) { return static_cast<int>(bits() % static_cast<std::uint64_t>(count)); }  // 0 to count - 1

 private:
  std::uint64_t seed_;
  std::uint64_t count_ = 0;
};

}  // namespace byre
