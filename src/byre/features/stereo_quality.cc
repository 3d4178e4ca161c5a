#include "byre/features/stereo_quality.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>

namespace byre {

bool is_partly_hidden(const StereoQuality& fit) {
  constexpr double kMinBestRate = 0.2;
  constexpr double kMaxRowOffsetIfHidden = 0.5;  // pixels
  return fit.matched < kMinMatchedShare && fit.best_match_rate >= kMinBestRate &&
         fit.row_error <= kMaxRowOffsetIfHidden;
}

bool is_consistent(const StereoQuality& fit) {
  return is_partly_hidden(fit) || (fit.matched >= kMinMatchedShare && fit.row_error <= kMaxRowOffset);
}

void MatchRateGrid::note(const Features& features, const Rig& rig) {
  for (Part& part : parts_) part = {memory_ * part.features, memory_ * part.matched};
  for (const Keypoint& keypoint : features.keypoints()) {
    const int column = std::clamp(static_cast<int>(kColumns * keypoint.pixel.x() / rig.width), 0, kColumns - 1);
    const int row = std::clamp(static_cast<int>(kRows * keypoint.pixel.y() / rig.height), 0, kRows - 1);
    Part& part = parts_[static_cast<std::size_t>(row * kColumns + column)];
    part.features += 1.0;
    if (keypoint.has_disparity()) part.matched += 1.0;
  }
}

double MatchRateGrid::best_rate() const {
  constexpr double kEnough = 10.0;  // features of a part
  std::array<double, kParts> all;
  std::size_t count = 0;
  for (const Part& part : parts_) {
    if (part.features >= kEnough) all[count++] = part.matched / part.features;
  }
  if (count == 0) return 0.0;
  const std::span shares = std::span(all).first(count);
  const auto tenth = shares.begin() + static_cast<std::ptrdiff_t>(count / 10);
  std::ranges::nth_element(shares, tenth, std::greater<>());
  return *tenth;
}

void CommonRowError::note(const Features& features, const Rig& rig) {
  for (const Keypoint& keypoint : features.keypoints()) {
    if (!keypoint.has_disparity()) continue;
    const auto bin = static_cast<int>(std::floor(kBinsPerPixel * keypoint.row_offset)) + kBins / 2;
    const std::size_t region = image_region_of(keypoint.pixel.x(), keypoint.pixel.y(), rig);
    ++counts_[region * kBins + static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1))];
  }
}

std::optional<double> CommonRowError::pixels() const {
  constexpr int kEnough = 30;  // features of a region
  double sum = 0.0;
  int regions = 0;
  for (std::size_t region = 0; region < static_cast<std::size_t>(kImageRegions); ++region) {
    const std::span<const int> counts = std::span(counts_).subspan(region * kBins, kBins);
    const int all = std::accumulate(counts.begin(), counts.end(), 0);
    if (all < kEnough) continue;
    int bin = 0;
    for (int below = counts[0]; 2 * below < all; below += counts[static_cast<std::size_t>(bin)]) ++bin;
    sum += std::pow((bin + 0.5 - kBins / 2) / kBinsPerPixel, 2);
    ++regions;
  }
  return regions == 0 ? std::nullopt : std::optional(std::sqrt(sum / regions));
}

}  // namespace byre
