#pragma once

#include "byre/features.h"

#include <bit>
#include <cstddef>
#include <cstdint>

namespace byre {

// Radius of the image region that orientation and descriptor of a keypoint read, octave pixels.
inline constexpr int kDescriptorRadius = 19;

// Direction from a pixel to the intensity centroid of the disc of radius 15 about it (Rublee 2011), radians.
// centre points at the pixel in a row-major image.
float orientation(const std::uint8_t* centre, std::ptrdiff_t stride);

// 256-bit BRIEF rotated by angle (radians), read from an image blurred by a Gaussian of sigma 2.
Descriptor describe(const std::uint8_t* blurred_centre, std::ptrdiff_t stride, float angle);

// Number of differing bits, 0 to 256.
inline int hamming_distance(const Descriptor& a, const Descriptor& b) {
  return std::popcount(a[0] ^ b[0]) + std::popcount(a[1] ^ b[1]) + std::popcount(a[2] ^ b[2]) +
         std::popcount(a[3] ^ b[3]);
}

}  // namespace byre
