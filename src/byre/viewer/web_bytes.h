#pragma once

#include "byre/viewer/scene.h"

#include <span>
#include <string>

namespace byre {

// What goes to the page as bytes instead of text, little-endian; web/src/decode.ts reads them.

// uint32 points and keyframes, then for each point float32 x, y, z, for each keyframe float32 x, y, z and its rotation
// as a quaternion x, y, z, w (map_from_body), and at last an uint8 for each point and for each keyframe: its origin, 0
// offline and 1 online.
std::string map_bytes(const MapScene& scene);

// uint32 number of the frame and count of points, for each point float32 u, v and an uint8 (1 online, 2 inlier, or
// both), then a JPEG file. Columns stand together: all pixels, then all kinds.
std::string image_bytes(std::size_t frame, std::span<const SeenPoint> seen, std::span<const unsigned char> jpeg);

}  // namespace byre
