#include "byre/simulation/camera_imperfection.h"

#include "byre/base/enum_names.h"
#include "byre/input_error.h"
#include "byre/io/image/image_codec.h"
#include "byre/simulation/row_workers.h"
#include "byre/simulation/seeded_draws.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include <opencv2/imgcodecs.hpp>

namespace byre {
namespace {

// Largest variance of one pass over neighbours: weights 1/4, 1/2, 1/4.
constexpr float kMaxVariancePerStep = 0.5f;

constexpr double kFocalSigma = 4e-4;
constexpr double kCentreSigma = 0.15;  // pixels
constexpr std::array<double, 4> kDistortionSigmas{1e-3, 1e-3, 1e-4, 1e-4};
constexpr double kTurnSigma = 0.01 * std::numbers::pi / 180.0;  // radians
constexpr double kMoveSigma = 1e-4;                             // metres

class NormalDraws {
 public:
  NormalDraws(double level, std::uint64_t seed) : level_(level), draws_(seed, 61) {}

  // Approximately normal: the sum of twelve uniform numbers has variance 1.
  double operator()(double sigma) {
    double sum = 0.0;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(draws_.between(-0.5f, 0.5f));
    return level_ * sigma * sum;
  }

 private:
  double level_;
  SeededDraws draws_;
};

CameraError draw_camera_error(NormalDraws& normal) {
  CameraError error;
  error.focal = normal(kFocalSigma);
  for (double& pixels : error.centre) pixels = normal(kCentreSigma);
  for (std::size_t i = 0; i < kDistortionSigmas.size(); ++i) error.distortion[i] = normal(kDistortionSigmas[i]);
  return error;
}

Camera perturbed(Camera camera, const CameraError& error) {
  camera.fx *= 1.0 + error.focal;
  camera.fy *= 1.0 + error.focal;
  camera.cx += error.centre.x();
  camera.cy += error.centre.y();
  const bool has_lens = std::ranges::any_of(error.distortion, [](double value) { return value != 0.0; });
  if (has_lens && camera.model == CameraModel::pinhole) camera.model = CameraModel::radial_tangential;
  for (std::size_t i = 0; i < error.distortion.size(); ++i) camera.distortion[i] += error.distortion[i];
  return camera;
}

}  // namespace

LensBlur::LensBlur(int width, int height, const LensBlurOptions& options) : width_(width), height_(height) {
  if (options.corner_sigma <= 0.0f) return;
  const auto half_width = 0.5f * static_cast<float>(width);
  const auto half_height = 0.5f * static_cast<float>(height);
  const float corner = half_width * half_width + half_height * half_height;
  variances_.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const float x = static_cast<float>(column) + 0.5f - half_width * (1.0f + 2.0f * options.sharpest.x());
      const float y = static_cast<float>(row) + 0.5f - half_height - static_cast<float>(width) * options.sharpest.y();
      const float sigma = options.corner_sigma * (x * x + y * y) / corner;
      variances_.push_back(sigma * sigma);
    }
  }
  const float largest = *std::ranges::max_element(variances_);
  steps_ = static_cast<int>(std::ceil(largest / kMaxVariancePerStep));
  step_variance_ = largest / static_cast<float>(steps_);
  for (float& variance : variances_) variance /= step_variance_;
}

std::size_t LensBlur::index(int column, int row) const {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column);
}

float LensBlur::sigma_at(int column, int row) const {
  return is_sharp() ? 0.0f : std::sqrt(step_variance_ * variances_[index(column, row)]);
}

// One pass down the columns and along the rows; adds the variance of one step everywhere.
std::vector<float> LensBlur::step_further(const std::vector<float>& image, int threads) const {
  const float aside = 0.5f * step_variance_;
  const float middle = 1.0f - step_variance_;
  std::vector<float> result(image.size());
  for_each_row(height_, threads, [&](int row) {
    const float* const here = &image[index(0, row)];
    const float* const above = &image[index(0, std::max(row - 1, 0))];
    const float* const below = &image[index(0, std::min(row + 1, height_ - 1))];
    std::vector<float> padded(static_cast<std::size_t>(width_) + 2);
    for (std::size_t i = 0; i < static_cast<std::size_t>(width_); ++i) {
      padded[i + 1] = middle * here[i] + aside * (above[i] + below[i]);
    }
    padded.front() = padded[1];
    padded.back() = padded[static_cast<std::size_t>(width_)];
    float* const out = &result[index(0, row)];
    for (std::size_t i = 0; i < static_cast<std::size_t>(width_); ++i) {
      out[i] = middle * padded[i + 1] + aside * (padded[i] + padded[i + 2]);
    }
  });
  return result;
}

// Interpolates between passes: the variance of a mixture of two normal distributions is the mixture of theirs.
std::vector<float> LensBlur::blurred(const std::vector<float>& image, int threads) const {
  std::vector<float> result = image;
  std::vector<float> here = image;
  for (int step = 0; step < steps_; ++step) {
    std::vector<float> further = step_further(here, threads);
    const auto steps_done = static_cast<float>(step);
    for (std::size_t i = 0; i < result.size(); ++i) {
      const float share = variances_[i] - steps_done;
      if (share > 0.0f) result[i] = here[i] + std::min(share, 1.0f) * (further[i] - here[i]);
    }
    here = std::move(further);
  }
  return result;
}

CalibrationError draw_calibration_error(double level, std::uint64_t seed) {
  NormalDraws normal(level, seed);
  CalibrationError error{draw_camera_error(normal), draw_camera_error(normal)};
  for (double& radians : error.right_rotation) radians = normal(kTurnSigma);
  for (double& metres : error.right_translation) metres = normal(kMoveSigma);
  return error;
}

Calibration perturbed(const Calibration& calibration, const CalibrationError& error) {
  Calibration result = calibration;
  result.left = perturbed(calibration.left, error.left);
  if (calibration.right) {
    const Pose true_from_nominal{rotation_exp(error.right_rotation), error.right_translation};  // right camera's frames
    result.right = StereoPartner{perturbed(calibration.right->camera, error.right),
                                 inverse(true_from_nominal) * calibration.right->right_from_left};
  }
  return result;
}

Calibration perturbed(const Calibration& calibration, double level, std::uint64_t seed) {
  return level == 0.0 ? calibration : perturbed(calibration, draw_calibration_error(level, seed));
}

std::string_view to_string(CameraCondition condition) {
  return name_among<CameraCondition::worn>({"exact", "good", "worn"}, condition);
}

CameraImperfection imperfection_of(CameraCondition condition) {
  CameraImperfection imperfection;
  switch (condition) {
    case CameraCondition::exact:
      break;
    case CameraCondition::good:
      imperfection.calibration_level = 1.0;
      imperfection.lens_blur = 0.4;
      imperfection.gain = 1.02;
      imperfection.offset = 1.0;
      break;
    case CameraCondition::worn:
      imperfection.calibration_level = 3.0;
      imperfection.lens_blur = 1.0;
      imperfection.gain = 1.08;
      imperfection.offset = 4.0;
      imperfection.vignetting = 0.45;
      imperfection.jpeg_quality = 85;
      break;
  }
  return imperfection;
}

void require_valid(const CameraImperfection& imperfection) {
  const auto require = [](bool holds, const char* reason) {
    if (!holds) throw InputError("simulated camera", reason);
  };
  const auto is_within = [](double value, double least, double most) { return value >= least && value <= most; };
  require(is_within(imperfection.calibration_level, 0.0, 10.0), "the calibration level must be from 0 to 10");
  require(is_within(imperfection.rolling_shutter_s, 0.0, 0.1), "the readout time must be from 0 to 100 milliseconds");
  require(is_within(imperfection.time_offset_s, -0.1, 0.1), "the time offset must be from -100 to 100 milliseconds");
  require(is_within(imperfection.lens_blur, 0.0, 5.0), "the lens blur must be from 0 to 5 pixels");
  require(is_within(imperfection.gain, 0.25, 4.0), "the gain must be from 0.25 to 4");
  require(is_within(imperfection.offset, -50.0, 50.0), "the offset must be from -50 to 50 grey values");
  require(is_within(imperfection.vignetting, 0.0, 0.9), "vignetting must be from 0 to 0.9");
  require(is_within(imperfection.jpeg_quality, 0.0, 100.0),
          "the JPEG quality must be from 1 to 100, or 0 for no compression");
}

LensBlurOptions lens_blur_of(const CameraImperfection& imperfection, StereoSide side) {
  const auto sigma = static_cast<float>(imperfection.lens_blur);
  if (side == StereoSide::left) return {sigma, {0.04f, -0.03f}};
  return {1.5f * sigma, {-0.07f, 0.02f}};
}

Image jpeg_compressed(const Image& image, int quality) {
  assert(quality >= 1 && quality <= 100);
  cv::Mat pixels(image.height, image.width, CV_8UC1);
  std::ranges::copy(image.pixels, pixels.data);
  const std::vector<std::uint8_t> bytes = encode_image(".jpg", pixels, {cv::IMWRITE_JPEG_QUALITY, quality});
  const cv::Mat decoded = decode_image(bytes, cv::IMREAD_GRAYSCALE);
  return {decoded.cols, decoded.rows, std::vector<std::uint8_t>(decoded.datastart, decoded.dataend)};
}

}  // namespace byre
