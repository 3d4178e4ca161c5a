#pragma once

#include "byre/floor_plan.h"

#include <cstdint>
#include <optional>

#include <opencv2/core.hpp>

namespace byre {

struct PlanPixel {
  double shade = 0.0;             // mean of the colours, 0 (black) to white
  std::optional<double> alpha{};  // 0 (transparent) to white; empty: the image has no alpha channel
  double white = 255.0;
};

// Occupancy by the rules of ROS 2's nav2_map_server, with one exception: a fully transparent pixel is unknown in every
// mode, whatever colour the drawing program left under it. In trinary mode alpha is one more channel of the mean.
std::int8_t occupancy_of(const PlanPixel& pixel, const FloorPlan& plan);

// The image to show, 8-bit BGR: on white where it is transparent, inverted where the plan is negated. Empty when it
// cannot be read.
cv::Mat shown_plan(const FloorPlan& plan);

}  // namespace byre
