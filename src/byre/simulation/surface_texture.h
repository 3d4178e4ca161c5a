#pragma once

#include <cstdint>

namespace byre {

// Deterministic hash of a seed and two integers (splitmix64 finaliser).
std::uint64_t hash(std::uint64_t seed, std::uint64_t first, std::uint64_t second);

// Sample position and resolution on a surface.
struct SurfaceSpot {
  float x = 0.0f;  // metres along the surface
  float y = 0.0f;
  float footprint = 0.0f;  // metres per pixel; finer detail is averaged
};

// Grey value, 0 to 255, of a procedural texture: smooth noise of several wavelengths, covered with discs, half discs
// and rectangles of random grey, position, size and direction at four scales, which give distinct corners near and far.
float surface_grey(std::uint64_t seed, const SurfaceSpot& spot);

}  // namespace byre
