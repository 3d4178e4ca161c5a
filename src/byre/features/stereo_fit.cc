#include "byre/features/stereo_fit.h"

#include <algorithm>
#include <array>
#include <functional>
#include <span>

namespace byre {

bool is_partly_hidden(const StereoFit& fit) {
  constexpr double kLeastAtBest = 0.2;
  constexpr double kMostRowOffsetOfFew = 0.5;  // pixels
  return fit.matched < kLeastStereoShare && fit.matched_at_best >= kLeastAtBest && fit.row_error <= kMostRowOffsetOfFew;
}

bool images_fit(const StereoFit& fit) {
  return is_partly_hidden(fit) || (fit.matched >= kLeastStereoShare && fit.row_error <= kMostRowOffset);
}

void MatchedByPart::note(const Features& features, const Rig& rig) {
  for (Part& part : parts_) part = {memory_ * part.features, memory_ * part.matched};
  for (const Keypoint& keypoint : features.keypoints()) {
    const int column = std::clamp(static_cast<int>(kColumns * keypoint.pixel.x() / rig.width), 0, kColumns - 1);
    const int row = std::clamp(static_cast<int>(kRows * keypoint.pixel.y() / rig.height), 0, kRows - 1);
    Part& part = parts_[static_cast<std::size_t>(row * kColumns + column)];
    part.features += 1.0;
    if (keypoint.has_disparity()) part.matched += 1.0;
  }
}

double MatchedByPart::at_best() const {
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

}  // namespace byre
