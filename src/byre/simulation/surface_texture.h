#pragma once

#include <cstdint>

namespace byre {

// Bits that look random but follow from the input: mixes seed and two whole numbers (splitmix64's finaliser).
std::uint64_t hash(std::uint64_t seed, std::uint64_t first, std::uint64_t second);

// Where on a surface to look, and how finely.
struct SurfaceSpot {
  float x = 0.0f;  // metres along the surface
  float y = 0.0f;
  float footprint = 0.0f;  // metres that a pixel covers there: finer detail is averaged away
};

// Grey value, 0 to 255, of a procedural texture: smooth noise of several wavelengths, and on it discs, half discs and
// rectangles of random grey, place, size and direction at four scales, so that there are distinct corners near and far.
float surface_grey(std::uint64_t seed, const SurfaceSpot& spot);

}  // namespace byre
