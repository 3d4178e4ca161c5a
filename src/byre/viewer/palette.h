#pragma once

#include "byre/map/ids.h"
#include "byre/slam/frame/health.h"
#include "byre/viewer/picture.h"

#include <array>

namespace byre::palette {

// Colours of pictures. The verdicts also differ in lightness, and in pictures in shape.

inline constexpr Colour kPaper{255, 255, 255};
inline constexpr Colour kInk{31, 35, 40};
inline constexpr Colour kFaint{110, 119, 129};
inline constexpr Colour kRule{208, 215, 222};
inline constexpr Colour kWash{246, 248, 250};
inline constexpr Colour kOffline{27, 158, 75};
inline constexpr Colour kOnline{142, 68, 173};
inline constexpr Colour kTrusted{17, 99, 41};
inline constexpr Colour kDegraded{230, 145, 0};
inline constexpr Colour kUntrusted{207, 34, 46};
inline constexpr Colour kCamera{9, 105, 218};
inline constexpr Colour kKeyframe{87, 96, 106};

// Colours of paths that differ by name only.
inline constexpr std::array kPaths = {Colour{9, 105, 218}, Colour{191, 57, 137}, Colour{180, 95, 6},
                                      Colour{17, 130, 140}, Colour{87, 60, 180}};

constexpr Colour of(Origin origin) {
  return origin == Origin::offline ? kOffline : kOnline;
}

constexpr Colour of(Verdict verdict) {
  if (verdict == Verdict::trusted) return kTrusted;
  return verdict == Verdict::degraded ? kDegraded : kUntrusted;
}

}  // namespace byre::palette
