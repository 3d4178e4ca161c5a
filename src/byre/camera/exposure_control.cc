#include "byre/camera/exposure_control.h"

#include "byre/input_error.h"

#include <algorithm>
#include <cmath>

#include <linux/videodev2.h>

namespace byre {
namespace {

constexpr double kUnit = 1e-4;  // seconds, unit of V4L2's absolute exposure

std::optional<ControlRange> range_of(const VideoDescriptor& descriptor, std::uint32_t control) {
  v4l2_queryctrl query{};
  query.id = control;
  const bool is_there = descriptor.call(VIDIOC_QUERYCTRL, &query) && (query.flags & V4L2_CTRL_FLAG_DISABLED) == 0;
  if (!is_there || query.maximum <= query.minimum) return std::nullopt;
  return ControlRange{query.minimum, query.maximum, std::max(1, query.step)};
}

bool set_control(const VideoDescriptor& descriptor, std::uint32_t control, int value) {
  v4l2_control setting{control, value};
  return descriptor.call(VIDIOC_S_CTRL, &setting);
}

std::optional<int> value_of(const VideoDescriptor& descriptor, std::uint32_t control) {
  v4l2_control setting{control, 0};
  return descriptor.call(VIDIOC_G_CTRL, &setting) ? std::optional(setting.value) : std::nullopt;
}

int on_step(const ControlRange& range, double value) {
  const double steps = std::round((value - range.min) / range.step);
  return std::clamp(range.min + static_cast<int>(steps) * range.step, range.min, range.max);
}

}  // namespace

int gain_value(const ControlRange& range, double gain) {
  return on_step(range, range.min + (gain - 1.0) / (kMaxGain - 1.0) * (range.max - range.min));
}

double gain_factor(const ControlRange& range, int value) {
  return 1.0 + (kMaxGain - 1.0) * (value - range.min) / (range.max - range.min);
}

ExposureControls::ExposureControls(const VideoDescriptor& descriptor, const std::string& place)
    : descriptor_(descriptor) {
  const auto exposure = range_of(descriptor, V4L2_CID_EXPOSURE_ABSOLUTE);
  // Controls that most cameras lack; failures are ignored.
  set_control(descriptor, V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0);
  set_control(descriptor, V4L2_CID_AUTOGAIN, 0);
  set_control(descriptor, V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL);
  if (!exposure ||
      value_of(descriptor, V4L2_CID_EXPOSURE_AUTO).value_or(V4L2_EXPOSURE_MANUAL) != V4L2_EXPOSURE_MANUAL) {
    throw InputError(place, "has no exposure time control", "omit the exposure limit");
  }
  exposure_ = *exposure;
  gain_ = range_of(descriptor, V4L2_CID_GAIN);
}

CameraExposureLimits ExposureControls::limits(double max_seconds) const {
  CameraExposureLimits limits;
  limits.min_seconds = std::max(1, exposure_.min) * kUnit;
  limits.max_seconds = std::max(limits.min_seconds, std::min(max_seconds, exposure_.max * kUnit));
  limits.max_gain = gain_ ? kMaxGain : 1.0;
  return limits;
}

CameraExposure ExposureControls::now() const {
  CameraExposure exposure;
  exposure.seconds = value_of(descriptor_, V4L2_CID_EXPOSURE_ABSOLUTE).value_or(exposure_.min) * kUnit;
  if (gain_) exposure.gain = gain_factor(*gain_, value_of(descriptor_, V4L2_CID_GAIN).value_or(gain_->min));
  return exposure;
}

// Rounds the time down, because of the limit.
bool ExposureControls::set(const CameraExposure& exposure) const {
  constexpr double kRounding = 1e-6;  // units
  const int units = static_cast<int>(std::floor(exposure.seconds / kUnit + kRounding));
  const int steps = std::max(0, (units - exposure_.min) / exposure_.step);
  const int value = std::min(exposure_.max, exposure_.min + steps * exposure_.step);
  const bool is_set = set_control(descriptor_, V4L2_CID_EXPOSURE_ABSOLUTE, value);
  return is_set && (!gain_ || set_control(descriptor_, V4L2_CID_GAIN, gain_value(*gain_, exposure.gain)));
}

}  // namespace byre
