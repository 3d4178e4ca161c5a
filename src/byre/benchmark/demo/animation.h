#pragma once

#include "byre/benchmark/demo/plan_pane.h"
#include "byre/viewer/scene.h"

#include <string>
#include <vector>

namespace byre {

// The demonstration in one picture: the hybrid run on the floor plan, the other arms below it at half the size, each
// with a line of figures, and a legend.
Picture mission_picture(const DemoPlace& place, const std::vector<DemoArm>& arms);

// Heading of an arm in plain words.
std::string plain_name(Arm arm);

// "on the plan after 1.4 s, trusted in 93 % of the frames, ..."
std::string figures_line(const DemoArm& arm);

inline constexpr int kAnimationFrames = 40;         // at most
inline constexpr double kAnimationRate = 6.0;       // frames per second
inline constexpr double kLastAnimationFrame = 1.5;  // seconds

// Frames of equal size: left the camera image with matched points of both maps, right the plan with the path up to the
// frame. filmed: frames of the hybrid run in order of time, from its first frame.
std::vector<Picture> animation_of(const DemoPlace& place, const DemoArm& hybrid, const std::vector<FrameScene>& filmed);

}  // namespace byre
