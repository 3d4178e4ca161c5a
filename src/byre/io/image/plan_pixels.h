#pragma once

#include "byre/floor_plan.h"

#include <cstdint>
#include <optional>

#include <opencv2/core.hpp>

namespace byre {

struct PlanPixel {
  double shade = 0.0;             // mean of the colour channels, 0 (black) to `white`
  std::optional<double> alpha{};  // 0 (transparent) to `white`; empty: the image has no alpha channel
  double white = 255.0;           // largest value of a channel
};

// Occupancy by the rules of ROS 2's nav2_map_server, with one exception: a fully transparent pixel is unknown in every
// mode, whatever its colour. In trinary mode alpha is a fourth channel of the mean.
std::int8_t occupancy_of(const PlanPixel& pixel, const FloorPlan& plan);

// The image for display, 8-bit BGR: transparent pixels on white, a negated plan inverted. Empty if it cannot be read.
cv::Mat render_plan(const FloorPlan& plan);

}  // namespace byre
