#pragma once

#include "byre/camera/exposure.h"
#include "byre/camera/video_descriptor.h"

#include <optional>
#include <string>

namespace byre {

// A number that a driver lets be set.
struct ControlRange {
  int min = 0;
  int max = 0;
  int step = 1;
};

// How many gain factors a driver's range of gain stands for. Drivers do not say; that it is about so, and what is seen
// afterwards, is enough to come to the right brightness.
inline constexpr double kMostGain = 16.0;

// The value of a driver's control for a gain factor, and back.
int gain_value(const ControlRange& range, double gain);
double gain_factor(const ControlRange& range, int value);

// Exposure time and gain of a device, by its driver's controls: exposure by hand, in units of 100 us.
class ExposureControls {
 public:
  // Switches automatic exposure and gain off. Throws InputError for a device whose exposure time cannot be set.
  ExposureControls(const VideoDescriptor& descriptor, const std::string& place);

  // What can be had of these limits.
  CameraExposureLimits limits(double max_seconds) const;
  CameraExposure now() const;
  // False when the device does not take it any more.
  bool set(const CameraExposure& exposure) const;

 private:
  const VideoDescriptor& descriptor_;
  ControlRange exposure_;             // units of 100 us
  std::optional<ControlRange> gain_;  // empty: the device has no gain to set
};

}  // namespace byre
