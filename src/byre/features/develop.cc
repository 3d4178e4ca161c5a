#include "byre/features/develop.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

constexpr float kTolerable = 3.5f;  // grey values: noise that corners and patches tolerate
constexpr float kLeft = 2.5f;       // grey values: noise remaining after smoothing

// Grey values below black at which the square root begins. Photon noise grows with the root of the intensity, so the
// root equalises it (Anscombe 1948); it also keeps windows from using up the range of grey values.
constexpr float kRootBegin = 32.0f;

// The curve for a gain of 1.
float along_root(float grey) {
  return 2.0f * std::sqrt(kRootBegin) * (std::sqrt(std::max(0.0f, grey + kRootBegin)) - std::sqrt(kRootBegin));
}

void draw_along_root(float gain, cv::Mat& fine) {
  fine += kRootBegin;
  cv::max(fine, 0.0f, fine);
  cv::sqrt(fine, fine);
  const float slope = 2.0f * gain * std::sqrt(kRootBegin);
  fine.convertTo(fine, CV_32F, slope, -slope * std::sqrt(kRootBegin));
}

// Standard deviation of a Gaussian that leaves this share of white noise: 1 / (2 sqrt(pi) sigma), for wide ones.
float smoothing_to(float share) {
  constexpr float kWidest = 2.5f;  // pixels: wider Gaussians leave nothing to track
  return std::min(kWidest, 1.0f / (2.0f * std::sqrt(std::numbers::pi_v<float>) * share));
}

}  // namespace

Development development_for(const ImageCondition& condition) {
  constexpr float kDull = 12.0f;      // grey values of contrast
  constexpr float kLeastSeen = 0.5f;  // grey values of contrast: lower contrast has no signal to amplify
  constexpr float kMaxGain = 8.0f;
  constexpr float kDark = 18.0f;  // grey values of brightness
  constexpr float kGainOfDark = 2.0f;
  Development development;
  if (condition.contrast < kLeastSeen) return development;
  development.is_curved = condition.brightness < kDark;
  const float least = development.is_curved ? kGainOfDark : 1.0f;
  development.gain = std::clamp(kDull / condition.contrast, least, kMaxGain);
  if (development.gain > 1.0f && !development.is_curved) {
    const float brightness = std::clamp(condition.brightness, 64.0f, 192.0f);  // leaves range for the amplified values
    development.offset = brightness - development.gain * condition.brightness;
  }
  const float noise = development.gain * condition.noise;
  if (noise > kTolerable) development.smoothing = smoothing_to(kLeft / noise);
  return development;
}

void develop(const Development& development, const cv::Mat& image, cv::Mat& fine, cv::Mat& developed) {
  const bool is_linear = !development.is_curved;
  image.convertTo(fine, CV_32F, is_linear ? development.gain : 1.0, is_linear ? development.offset : 0.0);
  if (development.smoothing > 0.0f) cv::GaussianBlur(fine, fine, {}, development.smoothing);
  if (development.is_curved) draw_along_root(development.gain, fine);
  fine.convertTo(developed, CV_8U);
}

ImageCondition condition_after(const Development& development, const ImageCondition& condition) {
  ImageCondition after = condition;
  if (development.is_curved) {
    const float slope = std::sqrt(kRootBegin / (kRootBegin + condition.brightness));
    after.brightness = development.gain * along_root(condition.brightness);
    after.contrast = development.gain * slope * condition.contrast;
    return after;
  }
  after.brightness = development.gain * condition.brightness + development.offset;
  after.contrast = development.gain * condition.contrast;
  return after;
}

}  // namespace byre
