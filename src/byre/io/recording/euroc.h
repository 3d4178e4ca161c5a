#pragma once

#include "byre/calibration.h"

#include <filesystem>
#include <string>

namespace byre {

struct EurocSensor {
  Camera camera;
  Pose body_from_camera;      // T_BS
  double readout_time = 0.0;  // seconds, see Calibration
};

// Reads a camera's sensor.yaml. Throws InputError with the field that is missing or invalid: a T_BS that is not a rigid
// transform, focal lengths that are not positive, a principal point outside the image, an unknown model, a wrong number
// of coefficients.
EurocSensor read_euroc_sensor(const std::filesystem::path& path);

// The text of such a file. comment: origin of the images, written at its head.
std::string write_euroc_sensor(const EurocSensor& sensor, double rate_hz, const std::string& comment);

}  // namespace byre
