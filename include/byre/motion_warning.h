#pragma once

#include "byre/trajectory.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace byre {

// Sensor, or other source, of the motion of the body.
enum class MotionSensor : std::uint8_t {
  wheels,
  gyroscope,
  accelerometer,
  body_motion  // motion handed to Slam::process
};

std::string_view to_string(MotionSensor sensor);

// Fault of a motion input. Each kind of fault is reported once.
struct MotionWarning {
  MotionSensor sensor = MotionSensor::wheels;
  Timestamp time{};    // time of the sample that showed the fault; zero where no single sample does
  std::string what;    // the fault with its value, and what becomes of the samples
  std::string remedy;  // what to change
};

// "wheels (barn/wheel.txt), at 12.340 s: WHAT; REMEDY". source: file or topic of the samples, left out where empty.
std::string to_text(const MotionWarning& warning, std::string_view source = "");

}  // namespace byre
