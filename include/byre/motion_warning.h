#pragma once

#include "byre/trajectory.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace byre {

// Source of measured motion, or of places.
enum class MotionSensor : std::uint8_t {
  wheels,
  gyroscope,
  accelerometer,
  body_motion,  // BodyMotion given to Slam::process
  tags          // AprilTags
};

std::string_view to_string(MotionSensor sensor);

// Fault of a motion input, reported once per kind and sensor, or of a tag.
struct MotionWarning {
  MotionSensor sensor = MotionSensor::wheels;
  Timestamp time{};    // time of the first faulty sample; zero if the fault is not of a single sample
  std::string what;    // fault with its value, and effect on the samples
  std::string remedy;  // advice to the user
};

// Text "wheels (barn/wheel.txt), at 12.340 s: WHAT; REMEDY". source: file or topic of the samples; may be empty.
std::string to_text(const MotionWarning& warning, std::string_view source = "");

}  // namespace byre
