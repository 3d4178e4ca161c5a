#pragma once

#include "byre/floor_plan.h"
#include "byre/viewer/scene.h"

#include <span>
#include <string>

namespace byre {

// Plan image as PNG, reduced to max_side pixels for browsers. Throws InputError if it cannot be read.
std::string plan_png(const FloorPlan& plan, int max_side = 4096);

// Binary messages to the page, little-endian; decoded by web/src/decode.ts.

// uint32 counts of points and keyframes; float32 x, y, z per point; float32 x, y, z and quaternion x, y, z, w per
// keyframe (map_from_body); uint8 origin per point and per keyframe: 0 offline, 1 online.
std::string map_bytes(const MapScene& scene);

// uint32 frame number and count of points; float32 u, v of all points; uint8 flags of all points (1 online, 2 inlier);
// then a JPEG file.
std::string image_bytes(std::size_t frame, std::span<const SeenPoint> seen, std::span<const unsigned char> jpeg);

}  // namespace byre
