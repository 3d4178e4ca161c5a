#include "byre/features/enhance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

constexpr float kMaxNoise = 3.5f;       // grey values: noise that corners and patches tolerate
constexpr float kResidualNoise = 2.5f;  // grey values: noise remaining after smoothing

// Grey values below black at which the square root begins. Photon noise grows with the root of the intensity, so the
// root equalises it (Anscombe 1948); it also keeps windows from using up the range of grey values.
constexpr float kRootOffset = 32.0f;

// The curve for a gain of 1.
float square_root_curve(float grey) {
  return 2.0f * std::sqrt(kRootOffset) * (std::sqrt(std::max(0.0f, grey + kRootOffset)) - std::sqrt(kRootOffset));
}

void apply_square_root(float gain, cv::Mat& fine) {
  fine += kRootOffset;
  cv::max(fine, 0.0f, fine);
  cv::sqrt(fine, fine);
  const float slope = 2.0f * gain * std::sqrt(kRootOffset);
  fine.convertTo(fine, CV_32F, slope, -slope * std::sqrt(kRootOffset));
}

// Standard deviation of a Gaussian that leaves this share of white noise: 1 / (2 sqrt(pi) sigma), for wide ones.
float sigma_for_share(float share) {
  constexpr float kWidest = 2.5f;  // pixels: wider Gaussians leave nothing to track
  return std::min(kWidest, 1.0f / (2.0f * std::sqrt(std::numbers::pi_v<float>) * share));
}

}  // namespace

Enhancement choose_enhancement(const ImageCondition& condition) {
  constexpr float kDull = 12.0f;        // grey values of contrast
  constexpr float kMinContrast = 0.5f;  // grey values of contrast: lower contrast has no signal to amplify
  constexpr float kMaxGain = 8.0f;
  constexpr float kDark = 18.0f;  // grey values of brightness
  constexpr float kGainOfDark = 2.0f;
  Enhancement enhancement;
  if (condition.contrast < kMinContrast) return enhancement;
  enhancement.uses_square_root = condition.brightness < kDark;
  const float least = enhancement.uses_square_root ? kGainOfDark : 1.0f;
  enhancement.gain = std::clamp(kDull / condition.contrast, least, kMaxGain);
  if (enhancement.gain > 1.0f && !enhancement.uses_square_root) {
    const float brightness = std::clamp(condition.brightness, 64.0f, 192.0f);  // leaves range for the amplified values
    enhancement.offset = brightness - enhancement.gain * condition.brightness;
  }
  const float noise = enhancement.gain * condition.noise;
  if (noise > kMaxNoise) enhancement.smoothing = sigma_for_share(kResidualNoise / noise);
  return enhancement;
}

void enhance(const Enhancement& enhancement, const cv::Mat& image, cv::Mat& fine, cv::Mat& enhanced) {
  const bool is_linear = !enhancement.uses_square_root;
  image.convertTo(fine, CV_32F, is_linear ? enhancement.gain : 1.0, is_linear ? enhancement.offset : 0.0);
  if (enhancement.smoothing > 0.0f) cv::GaussianBlur(fine, fine, {}, enhancement.smoothing);
  if (enhancement.uses_square_root) apply_square_root(enhancement.gain, fine);
  fine.convertTo(enhanced, CV_8U);
}

ImageCondition condition_after_enhancement(const Enhancement& enhancement, const ImageCondition& condition) {
  ImageCondition after = condition;
  if (enhancement.uses_square_root) {
    const float slope = std::sqrt(kRootOffset / (kRootOffset + condition.brightness));
    after.brightness = enhancement.gain * square_root_curve(condition.brightness);
    after.contrast = enhancement.gain * slope * condition.contrast;
    return after;
  }
  after.brightness = enhancement.gain * condition.brightness + enhancement.offset;
  after.contrast = enhancement.gain * condition.contrast;
  return after;
}

}  // namespace byre
