#pragma once

#include "byre/features.h"
#include "byre/geometry/image_regions.h"
#include "byre/rig.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace byre {

// Consistency of the two images of stereo pairs.
struct StereoQuality {
  double matched = 0.0;          // share of the left image's features found in the right one, usually 0.4 and more
  double best_match_rate = 0.0;  // same in the tenth of the image with the largest share
  double row_error = 0.0;        // median distance of matches from their row, pixels
};

// Limits of consistent pairs: least share of features matched, and largest median row offset. Worn calibrations cause
// up to 0.7 pixels.
inline constexpr double kMinMatchedShare = 0.12;
inline constexpr double kMaxRowOffset = 0.8;  // pixels

// Dirt on the lenses hides different parts of the two images. The remaining features match in the usual number and on
// their rows. With swapped, unsynchronised or rotated cameras, features match by chance and off their rows.
bool is_partly_hidden(const StereoQuality& fit);

bool is_consistent(const StereoQuality& fit);

// Share of features matched in the right image, per part of the left image.
class MatchRateGrid {
 public:
  explicit MatchRateGrid(double memory) : memory_(memory) {}  // share of earlier counts that is kept for the next pair

  void note(const Features& features, const Rig& rig);
  double best_rate() const;  // in the tenth of the parts with the largest share; 0 without enough features

 private:
  static constexpr int kColumns = 8, kRows = 6;
  static constexpr auto kParts = static_cast<std::size_t>(kColumns * kRows);
  struct Part {
    double features = 0.0;
    double matched = 0.0;
  };

  double memory_;  // constant after construction
  std::array<Part, kParts> parts_{};
};

// Pixels of CommonRowError above which a calibration is reported as off.
inline constexpr double kMaxCommonRowError = 0.5;

// Row error of a calibration: the median row offset of the features in each region of the image, root mean square over
// the regions, pixels. Medians are robust against wrong matches.
class CommonRowError {
 public:
  CommonRowError() : counts_(static_cast<std::size_t>(kImageRegions * kBins)) {}

  void note(const Features& features, const Rig& rig);
  std::optional<double> pixels() const;  // empty if no region has enough features

 private:
  static constexpr int kBinsPerPixel = 50;
  static constexpr int kBins = 9 * kBinsPerPixel;  // matches are less than 4.5 pixels off their row

  std::vector<int> counts_;  // features by region, then by row offset
};

}  // namespace byre
