#pragma once

#include "byre/features.h"
#include "byre/geometry/image_regions.h"
#include "byre/rig.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace byre {

// How well the images of pairs fit together.
struct StereoFit {
  double matched = 0.0;          // share of the left image's features found in the right one, usually 0.4 and more
  double matched_at_best = 0.0;  // the same in the tenth of the image where it is largest
  double row_error = 0.0;        // pixels by which they lie off their row, median
};

// What a pair leaves whose images fit together: such a share of the features is found in the right image, and the
// median of their rows is off by no more; worn calibrations leave up to 0.7.
inline constexpr double kLeastStereoShare = 0.12;
inline constexpr double kMostRowOffset = 0.8;  // pixels

// Dirt on the lenses hides different parts of what the cameras see. What is left is found as it should be, and on its
// rows. Where cameras are swapped, out of step or turned, features are found by chance, beside their rows.
bool is_partly_hidden(const StereoFit& fit);

bool images_fit(const StereoFit& fit);

// The share of features that are found in the right image, by parts of the left one.
class MatchedByPart {
 public:
  explicit MatchedByPart(double memory)
      : memory_(memory) {}  // share of what was counted that is kept for the next pair

  void note(const Features& features, const Rig& rig);
  double at_best() const;  // in the tenth of the parts where it is largest; 0 where none has enough features

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
inline constexpr double kFarOffCalibration = 0.5;

// Row error of a calibration: the median row offset of the features in each region of the image, root mean square over
// the regions, pixels. Medians are robust against wrong matches.
class CommonRowError {
 public:
  CommonRowError() : counts_(static_cast<std::size_t>(kImageRegions * kBins)) {}

  void note(const Features& features, const Rig& rig);
  std::optional<double> pixels() const;  // empty if no region has enough features

 private:
  static constexpr int kBinsPerPixel = 50;
  static constexpr int kBins = 9 * kBinsPerPixel;  // matches lie less than 4.5 pixels off their row

  std::vector<int> counts_;  // features by region, then by row offset
};

}  // namespace byre
