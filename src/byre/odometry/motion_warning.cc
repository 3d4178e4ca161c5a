#include "byre/motion_warning.h"

#include "byre/base/enum_names.h"

#include <fmt/format.h>

namespace byre {

std::string_view to_string(MotionSensor sensor) {
  return name_among<MotionSensor::tags>({"wheels", "gyroscope", "accelerometer", "motion of the body", "AprilTags"},
                                        sensor);
}

std::string to_text(const MotionWarning& warning, std::string_view source) {
  std::string text(to_string(warning.sensor));
  if (!source.empty()) text += " (" + std::string(source) + ")";
  if (warning.time != Timestamp{}) text += fmt::format(", at {:.3f} s", to_seconds(warning.time));
  return text + ": " + warning.what + (warning.remedy.empty() ? "" : "; " + warning.remedy);
}

}  // namespace byre
