#include "byre/camera/exposure.h"

#include "byre/input_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numeric>

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

constexpr int kGridColumns = 8;
constexpr int kGridRows = 6;
constexpr int kStep = 2;  // pixels between sampled pixels, both ways

// Shim's curve of a gradient, from 0 to 1: zero below the noise threshold, and flat for strong gradients.
double information_of(double gradient) {
  constexpr double kThreshold = 0.06;
  constexpr double kLambda = 1e3;
  if (gradient < kThreshold) return 0.0;
  static const double scale = std::log(kLambda * (1.0 - kThreshold) + 1.0);
  return std::log(kLambda * (gradient - kThreshold) + 1.0) / scale;
}

// Information by the difference of grey values.
std::array<float, 256> information_table() {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = static_cast<float>(information_of(static_cast<double>(i) / 255.0));
  }
  return table;
}

constexpr std::uint8_t kFull = 251;  // grey value from which a pixel counts as saturated
constexpr int kNoise = 4;            // grey values: smaller gradients count as zero at any exposure

// Predicted grey values for an exposure factor.
std::array<std::uint8_t, 256> values_with(double factor) {
  std::array<std::uint8_t, 256> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = i >= kFull ? 255.0 : std::min(255.0, factor * static_cast<double>(i));
    values[i] = static_cast<std::uint8_t>(std::lround(value));
  }
  return values;
}

// Without gradients, only a nearly black or nearly white image indicates a direction.
double factor_of_blank(const Image& image) {
  constexpr double kMuch = 2.0;
  constexpr double kDark = 32.0, kBright = 223.0;  // mean grey values
  const double mean = std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0) /
                      static_cast<double>(std::max<std::size_t>(1, image.pixels.size()));
  if (mean > kBright) return 1.0 / kMuch;
  return mean < kDark ? kMuch : 1.0;
}

}  // namespace

double corner_information(const Image& image, double factor) {
  static const std::array<float, 256> information = information_table();
  const std::array<std::uint8_t, 256> values = values_with(factor);
  std::array<double, kGridColumns * kGridRows> sums{};
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
  };
  const auto gradient = [&](std::uint8_t a, std::uint8_t b) {
    return std::abs(int{a} - int{b}) < kNoise ? 0 : std::abs(int{values[a]} - int{values[b]});
  };
  for (int y = 0; y + kStep < image.height; y += kStep) {
    const int row = y * kGridRows / image.height;
    for (int x = 0; x + kStep < image.width; x += kStep) {
      const std::uint8_t here = image.pixels[index(x, y)];
      const int steepest = std::max(gradient(here, image.pixels[index(x + kStep, y)]),
                                    gradient(here, image.pixels[index(x, y + kStep)]));
      sums[static_cast<std::size_t>(row * kGridColumns + x * kGridColumns / image.width)] +=
          information[static_cast<std::size_t>(steepest)];
    }
  }
  double total = 0.0;
  for (const double sum : sums) total += std::log1p(sum);
  return total;
}

double best_exposure_factor(const Image& image) {
  constexpr std::array kFactors = {1.0, 1.0 / 1.1, 1.1, 1.0 / 1.3, 1.3, 1.0 / 1.7, 1.7, 1.0 / 2.3, 2.3, 4.0, 8.0};
  constexpr double kClearly = 1.003;  // ignores insignificant improvements
  constexpr double kNothing = 1.0;
  double best = kFactors.front();
  double most = kClearly * corner_information(image, best);
  for (const double factor : kFactors) {
    const double information = corner_information(image, factor);
    if (information <= most) continue;
    most = information;
    best = factor;
  }
  return most < kNothing ? factor_of_blank(image) : best;
}

CameraExposure next_exposure(const CameraExposure& now, double factor, const CameraExposureLimits& limits) {
  constexpr double kShare = 0.7;  // share of the step, in the logarithm
  constexpr double kMax = 2.0;
  const double change = std::clamp(std::pow(factor, kShare), 1.0 / kMax, kMax);
  const double light = std::max(now.light(), limits.min_seconds) * change;
  CameraExposure next;
  next.seconds = std::clamp(light, limits.min_seconds, limits.max_seconds);
  next.gain = std::clamp(light / next.seconds, 1.0, std::max(1.0, limits.max_gain));
  return next;
}

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
