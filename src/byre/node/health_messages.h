#pragma once

#include "byre/frame_report.h"
#include "byre/ros/messages.h"

#include <string>

namespace byre {

// What the frame says of how well it is known where the robot is: OK trusted, WARN degraded, ERROR untrusted.
ros::DiagnosticStatus localisation_status(const FrameReport& report);

// What to do about a doubt; empty where there is nothing to do.
std::string advice_for(Doubt doubt);

// Time, state, health and the pose in the map, as one line of JSON.
std::string health_line(const FrameReport& report);

}  // namespace byre
