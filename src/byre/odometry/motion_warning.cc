#include "byre/motion_warning.h"

#include <fmt/format.h>

namespace byre {

std::string_view to_string(MotionSensor sensor) {
  switch (sensor) {
    case MotionSensor::wheels:
      return "wheels";
    case MotionSensor::gyroscope:
      return "gyroscope";
    case MotionSensor::accelerometer:
      return "accelerometer";
    case MotionSensor::body_motion:
      return "motion of the body";
    case MotionSensor::tags:
      return "AprilTags";
  }
  return "";
}

std::string to_text(const MotionWarning& warning, std::string_view source) {
  std::string text(to_string(warning.sensor));
  if (!source.empty()) text += " (" + std::string(source) + ")";
  if (warning.time != Timestamp{}) text += fmt::format(", at {:.3f} s", to_seconds(warning.time));
  return text + ": " + warning.what + (warning.remedy.empty() ? "" : "; " + warning.remedy);
}

}  // namespace byre
