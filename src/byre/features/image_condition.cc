#include "byre/image_condition.h"

#include "byre/base/enum_names.h"
#include "byre/base/scratch_memory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace byre {
namespace {

constexpr int kRowStep = 8;
constexpr int kMargin = 16;  // pixels, largest distance between the pixels of a pair, to each side and below

// Pairs of pixels, near and far, along one direction of the image.
struct Direction {
  int right = 0;  // columns of one step
  int down = 0;   // rows of one step
  int near = 0;   // steps
  int far = 0;

  std::ptrdiff_t offset(int steps, std::ptrdiff_t stride) const { return steps * (down * stride + right); }
};

// Distances of 2 and 16 pixels, approximately for the longer steps of the diagonals.
constexpr std::array<Direction, 4> kDirections = {{{1, 0, 2, 16}, {0, 1, 2, 16}, {1, 1, 1, 11}, {-1, 1, 1, 11}}};

// A structure function (Kolmogorov 1941): the mean squared difference at two distances.
struct Differences {
  double near = 0.0;  // squared grey values
  double far = 0.0;
};

int sum_of_squared_differences(const std::uint8_t* a, const std::uint8_t* b, int count) {
  int sum = 0;
  for (int i = 0; i < count; ++i) {
    const int difference = int{a[i]} - int{b[i]};
    sum += difference * difference;
  }
  return sum;
}

// Precondition: there are pixels to compare.
std::array<Differences, kDirections.size()> differences_of(const Image& image) {
  std::array<Differences, kDirections.size()> differences;
  const std::ptrdiff_t stride = image.width;
  const int columns = image.width - 2 * kMargin;
  double pairs = 0.0;
  for (int y = 0; y + kMargin < image.height; y += kRowStep) {
    const std::uint8_t* const row = image.pixels.data() + y * stride + kMargin;
    for (std::size_t i = 0; i < kDirections.size(); ++i) {
      const Direction& direction = kDirections[i];
      differences[i].near += sum_of_squared_differences(row, row + direction.offset(direction.near, stride), columns);
      differences[i].far += sum_of_squared_differences(row, row + direction.offset(direction.far, stride), columns);
    }
    pairs += columns;
  }
  for (Differences& difference : differences) difference = {difference.near / pairs, difference.far / pairs};
  return differences;
}

struct Light {
  float brightness = 0.0f;
  float clipped = 0.0f;
};

Light light_of(const Image& image) {
  constexpr std::uint8_t kBlack = 2, kWhite = 253;
  double sum = 0.0, clipped = 0.0, count = 0.0;
  for (int y = 0; y < image.height; y += kRowStep) {
    const std::uint8_t* const row = image.pixels.data() + static_cast<std::ptrdiff_t>(y) * image.width;
    int row_sum = 0, row_clipped = 0;
    for (int x = 0; x < image.width; ++x) {
      row_sum += row[x];
      row_clipped += row[x] <= kBlack || row[x] >= kWhite ? 1 : 0;
    }
    sum += row_sum;
    clipped += row_clipped;
    count += image.width;
  }
  if (count == 0.0) return {};
  return {static_cast<float>(sum / count), static_cast<float>(clipped / count)};
}

// Noise by second differences in both directions (Immerkaer 1996, Fast noise variance estimation), which have six times
// its standard deviation. Uses their lower quartile, because of texture. Clipped pixels are excluded.
float noise_of(const Image& image) {
  constexpr int kLargest = 8 * 255;
  constexpr std::uint16_t kClipped = kLargest + 1;
  constexpr double kQuartile = 0.3186;  // lower quartile of the magnitude of a normal distribution, in its sigmas
  constexpr double kGain = 6.0;         // root of the sum of the squared weights
  // Two alternating histograms: incrementing the same one twice in a row would stall.
  std::array<std::array<int, kClipped + 1>, 2> raised{};
  const std::ptrdiff_t stride = image.width;
  const auto width = static_cast<std::size_t>(image.width);
  ScratchVector<std::int16_t> across(width);        // second differences between rows
  ScratchVector<std::uint16_t> differences(width);  // second differences in both directions
  for (int y = kRowStep; y + 1 < image.height; y += kRowStep) {
    const std::uint8_t* const row = image.pixels.data() + y * stride;
    const std::uint8_t* const above = row - stride;
    const std::uint8_t* const below = row + stride;
    for (std::size_t x = 0; x < width; ++x) across[x] = static_cast<std::int16_t>(above[x] - 2 * row[x] + below[x]);
    for (std::size_t x = 1; x + 1 < width; ++x) {
      const auto difference = static_cast<std::int16_t>(across[x - 1] - 2 * across[x] + across[x + 1]);
      const auto magnitude = static_cast<std::uint16_t>(std::abs(difference));
      differences[x] = row[x] <= 1 || row[x] >= 254 ? kClipped : magnitude;
    }
    for (std::size_t x = 1; x + 1 < width; ++x) ++raised[x % 2][differences[x]];
  }
  std::array<int, kLargest + 1> counts;
  int count = 0;
  for (std::size_t value = 0; value < counts.size(); ++value) {
    counts[value] = raised[0][value] + raised[1][value];
    count += counts[value];
  }
  const double wanted = 0.25 * count;
  double below = 0.0;
  for (std::size_t value = 0; value < counts.size(); ++value) {
    if (counts[value] == 0 || below + counts[value] < wanted) {
      below += counts[value];
      continue;
    }
    // Values are rounded: zero represents values up to 0.5, any other value v those from v - 0.5 to v + 0.5.
    const double share = (wanted - below) / counts[value];
    const double quartile = value == 0 ? 0.5 * share : static_cast<double>(value) - 0.5 + share;
    return static_cast<float>(quartile / (kQuartile * kGain));
  }
  return 0.0f;
}

}  // namespace

ImageCondition measure_condition(const Image& image) {
  const Light light = light_of(image);
  if (image.width <= 2 * kMargin || image.height <= kMargin) return {light.brightness, 0.0f, light.clipped, 0.0f, 0.0f};
  const auto differences = differences_of(image);
  double contrast = 0.0;  // squared grey values
  double sharpness = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < kDirections.size(); ++i) {
    const auto& [near, far] = differences[i];
    contrast += std::max(0.0, far - near) / (2.0 * kDirections.size());
    const double steps = static_cast<double>(kDirections[i].far) / kDirections[i].near;
    sharpness = std::min(sharpness, far > 0.0 ? steps * near / far : 0.0);
  }
  return {light.brightness, static_cast<float>(std::sqrt(contrast)), light.clipped, static_cast<float>(sharpness),
          noise_of(image)};
}

std::string_view to_string(ImageFault fault) {
  return name_among<ImageFault::blurred>({"none", "dark", "overexposed", "flat", "blurred"}, fault);
}

ImageFault fault_of(const ImageCondition& condition, const ImageConditionOptions& options) {
  if (condition.brightness < options.min_brightness) return ImageFault::dark;
  if (condition.brightness > options.max_brightness) return ImageFault::overexposed;
  if (condition.contrast < options.min_contrast) return ImageFault::flat;
  if (condition.sharpness < options.min_sharpness) return ImageFault::blurred;
  return ImageFault::none;
}

}  // namespace byre
