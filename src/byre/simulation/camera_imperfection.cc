#include "byre/simulation/camera_imperfection.h"

#include "byre/input_error.h"
#include "byre/io/image/image_codec.h"

#include <algorithm>
#include <array>
#include <cassert>

#include <opencv2/imgcodecs.hpp>

namespace byre {

std::string_view to_string(CameraCondition condition) {
  switch (condition) {
    case CameraCondition::exact:
      return "exact";
    case CameraCondition::good:
      return "good";
    case CameraCondition::worn:
      return "worn";
  }
  return "";
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
