#pragma once

#include "degradation.h"

#include "byre/calibration.h"
#include "byre/simulation/camera_imperfection.h"

#include <cstdint>
#include <string>

namespace byre {

// Deviations of a robot's camera from its calibration. Recordings stay unchanged: calibrations are perturbed, and
// images are degraded when read.
struct Imperfection {
  CameraCondition condition = CameraCondition::good;
  std::uint64_t calibration_seed = 1;
  double focal_factor = 1.0;  // ratio of given to true focal lengths

  bool operator==(const Imperfection&) const = default;
};

std::string name_of(const Imperfection& imperfection);  // unique name such as "exact" or "good_1"

// The perturbed calibration that the robot is given.
Calibration nominal_calibration(const Calibration& calibration, const Imperfection& imperfection);

// Degradations of the images: lens blur, gain and offset of the right camera, JPEG loss. None for exact cameras.
Degradation imperfect_cameras(const Imperfection& imperfection);

}  // namespace byre
