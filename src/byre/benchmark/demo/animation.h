#pragma once

#include "byre/benchmark/demo/plan_pane.h"
#include "byre/viewer/scene.h"

#include <vector>

namespace byre {

inline constexpr int kAnimationFrames = 40;         // at most
inline constexpr double kAnimationRate = 6.0;       // frames per second
inline constexpr double kLastAnimationFrame = 1.5;  // seconds

// Frames of equal size: left the camera image with matched points of both maps, right the plan with the path up to the
// frame. filmed: frames of the hybrid run in order of time, from its first frame.
std::vector<Picture> animation_of(const DemoPlace& place, const DemoArm& hybrid, const std::vector<FrameScene>& filmed);

}  // namespace byre
