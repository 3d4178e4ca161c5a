#pragma once

#include "byre/odometry/motion_check.h"

#include <vector>

namespace byre {

// Warnings of sensors whose samples do not overlap in time with the frames.
std::vector<MotionWarning> clock_warnings(const MotionSamples& samples, Timestamp first_frame, Timestamp last_frame);

// All checks of MotionCheck that need no images, and clock_warnings.
std::vector<MotionWarning> check_motion(const MotionSamples& samples, Timestamp first_frame, Timestamp last_frame,
                                        const MotionLimits& limits = {});

}  // namespace byre
