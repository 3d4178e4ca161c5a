#pragma once

#include "byre/camera/video_descriptor.h"
#include "byre/image.h"

#include <optional>
#include <string>

namespace byre {

struct CameraExposure {
  double seconds = 0.0;
  double gain = 1.0;  // factor; 1 without amplification

  double light() const { return seconds * gain; }
};

struct CameraExposureLimits {
  double min_seconds = 1e-4;
  double max_seconds = 5e-3;  // longer exposures cause motion blur
  double max_gain = 1.0;      // factor
};

// Corner information of an image if its exposure were multiplied by the factor: predicted gradients between pixels,
// weighted by the curve of Shim, Lee and Kweon 2014 ("Auto-adjusting camera exposure for outdoor robotics using
// gradient information"), summed over the cells of a grid. Pixels are linear in the exposure until they saturate, as in
// Zhang, Forster and Scaramuzza 2017 ("Active exposure control for robust visual odometry in HDR environments");
// saturated pixels stay saturated at lower factors. The logarithm of each cell counts, so that corners all over the
// image outweigh many in one place.
double corner_information(const Image& image, double factor);

// Exposure factor with the most corner information, among several candidates. For an image without information it
// depends on whether the image is too bright or too dark.
double best_exposure_factor(const Image& image);

// Exposure after an image with this best factor: a damped step, at most a factor of two, so that the control converges.
// Raises the exposure time up to its limit first, then the gain.
CameraExposure next_exposure(const CameraExposure& now, double factor, const CameraExposureLimits& limits);

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
