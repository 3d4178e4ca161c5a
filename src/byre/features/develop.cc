#include "byre/features/develop.h"

#include <algorithm>
#include <numbers>

#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

constexpr float kTolerable = 3.5f;  // grey values: noise up to which corners and patches do well
constexpr float kLeft = 2.5f;       // grey values: noise that smoothing leaves

// The standard deviation of a Gaussian that leaves a share of white noise: 1 / (2 sqrt(pi) sigma), for wide ones.
float smoothing_to(float share) {
  constexpr float kWidest = 2.5f;  // pixels: beyond, there is nothing left to track
  return std::min(kWidest, 1.0f / (2.0f * std::sqrt(std::numbers::pi_v<float>) * share));
}

}  // namespace

Development development_for(const ImageCondition& condition) {
  constexpr float kDull = 12.0f;      // grey values of contrast
  constexpr float kLeastSeen = 0.5f;  // grey values of contrast: below there is nothing to bring out
  constexpr float kMaxGain = 8.0f;
  Development development;
  if (condition.contrast < kLeastSeen) return development;
  development.gain = std::clamp(kDull / condition.contrast, 1.0f, kMaxGain);
  if (development.gain > 1.0f) {
    const float brightness = std::clamp(condition.brightness, 64.0f, 192.0f);  // room for what is brought out
    development.offset = brightness - development.gain * condition.brightness;
  }
  const float noise = development.gain * condition.noise;
  if (noise > kTolerable) development.smoothing = smoothing_to(kLeft / noise);
  return development;
}

void develop(const Development& development, const cv::Mat& image, cv::Mat& fine, cv::Mat& developed) {
  image.convertTo(fine, CV_32F, development.gain, development.offset);
  if (development.smoothing > 0.0f) cv::GaussianBlur(fine, fine, {}, development.smoothing);
  fine.convertTo(developed, CV_8U);
}

ImageCondition condition_after(const Development& development, const ImageCondition& condition) {
  ImageCondition after = condition;
  after.brightness = development.gain * condition.brightness + development.offset;
  after.contrast = development.gain * condition.contrast;
  return after;
}

}  // namespace byre
