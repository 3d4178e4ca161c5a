#pragma once

#include "degradation.h"

#include "byre/calibration.h"
#include "byre/simulation/camera_imperfection.h"

#include <cstdint>
#include <string>

namespace byre {

// How far a robot's camera is from what the robot knows of it. Recordings stay as they are: calibrations are made to
// err, and images degraded while they are read.
struct Imperfection {
  CameraCondition condition = CameraCondition::good;
  std::uint64_t calibration_seed = 1;
  double focal_factor = 1.0;  // told focal lengths over the true ones

  bool operator==(const Imperfection&) const = default;
};

std::string name_of(const Imperfection& imperfection);  // "exact", "good_1"; different for different ones

// What the robot takes its cameras for.
Calibration told_calibration(const Calibration& calibration, const Imperfection& imperfection);

// What its cameras make of images: blur of the lenses, gain and offset of the right one, loss by JPEG. Nothing where
// they are exact.
Degradation imperfect_cameras(const Imperfection& imperfection);

}  // namespace byre
