#include "byre/io/image/plan_pixels.h"

#include "byre/input_error.h"
#include "byre/io/image/image_codec.h"
#include "byre/io/image/image_file.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

constexpr int kColours = 3, kWithAlpha = 4;  // channels

cv::Mat decode_plan(const FloorPlan& plan, int flags) {
  return decode_image_file(plan.image, flags | cv::IMREAD_IGNORE_ORIENTATION);
}

// channels: 1 (grey), 3 (colours) or 4 (colours and alpha).
template <typename Value>
PlanPixel pixel_of(const Value* values, int channels, double white) {
  const int colours = std::min(channels, kColours);
  double sum = 0.0;
  for (int i = 0; i < colours; ++i) sum += values[i];
  const auto alpha = channels < kWithAlpha ? std::nullopt : std::optional<double>(values[kColours]);
  return {sum / colours, alpha, white};
}

template <typename Value>
std::vector<std::int8_t> occupancy_of_all(const cv::Mat& pixels, double white, const FloorPlan& plan) {
  std::vector<std::int8_t> occupancy;
  occupancy.reserve(pixels.total());
  const int channels = pixels.channels();
  for (int row = 0; row < pixels.rows; ++row) {
    const Value* const values = pixels.ptr<Value>(row);
    for (int column = 0; column < pixels.cols; ++column) {
      occupancy.push_back(occupancy_of(pixel_of(values + column * channels, channels, white), plan));
    }
  }
  return occupancy;
}

std::vector<std::int8_t> read_occupancy(const FloorPlan& plan) {
  constexpr double kWhite8 = 255.0, kWhite16 = 65535.0;
  const cv::Mat pixels = decode_plan(plan, cv::IMREAD_UNCHANGED);
  const bool has_known_channels =
      pixels.channels() == 1 || pixels.channels() == kColours || pixels.channels() == kWithAlpha;
  if (has_known_channels && pixels.depth() == CV_8U) return occupancy_of_all<std::uint8_t>(pixels, kWhite8, plan);
  if (has_known_channels && pixels.depth() == CV_16U) return occupancy_of_all<std::uint16_t>(pixels, kWhite16, plan);
  throw InputError(plan.image.string(), "is not a grey or colour image with 8 or 16 bits", "save it as an 8-bit PNG");
}

void blend_on_white(cv::Mat& image) {
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      auto& pixel = image.at<cv::Vec4b>(row, column);
      for (int i = 0; i < kColours; ++i) {
        pixel[i] = static_cast<std::uint8_t>((pixel[i] * pixel[3] + 255 * (255 - pixel[3]) + 127) / 255);
      }
    }
  }
  cv::cvtColor(image, image, cv::COLOR_BGRA2BGR);
}

}  // namespace

std::int8_t occupancy_of(const PlanPixel& pixel, const FloorPlan& plan) {
  constexpr double kUsualOccupied = 0.65, kPercent = 100.0;
  const auto& [colours, alpha, white] = pixel;
  if (alpha == 0.0) return kUnknownPixel;
  if (plan.mode == PlanMode::raw) {
    const double value = std::round(255.0 * colours / white);
    return value <= kPercent ? static_cast<std::int8_t>(value) : kUnknownPixel;
  }
  if (plan.mode == PlanMode::scale && alpha.value_or(white) < white) return kUnknownPixel;
  const bool counts_alpha = plan.mode == PlanMode::trinary && alpha;
  const double shade = counts_alpha ? (kColours * colours + *alpha) / kWithAlpha : colours;
  const double darkness = (plan.is_negated ? shade : white - shade) / white;
  const double occupied = plan.occupied_threshold.value_or(kUsualOccupied);
  if (darkness > occupied) return kOccupiedPixel;
  if (darkness < plan.free_threshold) return kFreePixel;
  if (plan.mode == PlanMode::trinary) return kUnknownPixel;
  const double share = (darkness - plan.free_threshold) / (occupied - plan.free_threshold);
  return static_cast<std::int8_t>(std::rint(kPercent * share));
}

cv::Mat render_plan(const FloorPlan& plan) {
  cv::Mat image = decode_plan(plan, cv::IMREAD_UNCHANGED);
  if (image.channels() == kWithAlpha && !image.empty()) {
    if (image.depth() == CV_16U) image.convertTo(image, CV_8U, 1.0 / 256.0);
    if (image.depth() != CV_8U) return {};
    blend_on_white(image);
  } else {
    image = decode_plan(plan, cv::IMREAD_COLOR);
  }
  if (plan.is_negated) image = cv::Scalar::all(255) - image;
  return image;
}

DrawnFloorPlan read_plan_pixels(const FloorPlan& plan) {
  ImageReading<Image> reading = try_image(plan.image);
  if (!reading.image) throw InputError(plan.image.string(), reading.failure, "export the floor plan again");
  DrawnFloorPlan drawn{plan, std::move(*reading.image), read_occupancy(plan)};
  const bool is_shown_as_it_is = !plan.is_negated && decode_plan(plan, cv::IMREAD_UNCHANGED).channels() < kWithAlpha;
  if (is_shown_as_it_is) return drawn;
  cv::Mat grey;
  cv::cvtColor(render_plan(plan), grey, cv::COLOR_BGR2GRAY);
  drawn.image.pixels.assign(grey.begin<std::uint8_t>(), grey.end<std::uint8_t>());
  return drawn;
}

}  // namespace byre
