#pragma once

#include "byre/camera/exposure.h"
#include "byre/camera/video_descriptor.h"

#include <optional>
#include <string>

namespace byre {

struct ControlRange {
  int min = 0;
  int max = 0;
  int step = 1;
};

// Assumed gain factor at the upper end of a driver's range, which drivers do not report. The feedback of images
// corrects the error.
inline constexpr double kMaxGain = 16.0;

// Converts a gain factor to the value of a driver's control, and back.
int gain_value(const ControlRange& range, double gain);
double gain_factor(const ControlRange& range, int value);

// Manual exposure time and gain of a device by its driver's controls. Exposure is in units of 100 us.
class ExposureControls {
 public:
  // Disables automatic exposure and gain. Throws InputError for a device without a manual exposure time.
  ExposureControls(const VideoDescriptor& descriptor, const std::string& place);

  // Limits within the ranges of the device.
  CameraExposureLimits limits(double max_seconds) const;
  CameraExposure now() const;
  // False if the device rejects it.
  bool set(const CameraExposure& exposure) const;

 private:
  const VideoDescriptor& descriptor_;
  ControlRange exposure_;             // units of 100 us
  std::optional<ControlRange> gain_;  // empty if the device has no gain control
};

}  // namespace byre
