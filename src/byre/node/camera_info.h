#pragma once

#include "byre/calibration.h"
#include "byre/ros/messages.h"

#include <optional>
#include <string>

namespace byre {

// A calibration as camera drivers of ROS tell it (REP-104). The right camera lies where the rectification of the pair
// says: its P holds the baseline. Where images are rectified, P and no distortion hold. The body is the left camera.
// Throws InputError, with the topic, for what is not calibrated, not supported or makes no sense.
struct CameraInfoTopics {
  std::string left;
  std::string right;
};
Calibration calibration_of(const ros::CameraInfo& left, const std::optional<ros::CameraInfo>& right, bool is_rectified,
                           const CameraInfoTopics& topics);

}  // namespace byre
