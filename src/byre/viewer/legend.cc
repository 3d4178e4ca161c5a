#include "byre/viewer/legend.h"

#include "byre/viewer/palette.h"

#include <cmath>

#include <fmt/core.h>

namespace byre {
namespace {

using Eigen::Vector2d;

constexpr double kLegendTextSize = 13.0;  // pixels, for all lengths in this file
constexpr double kCharacter = 7.6;        // upper bound of the mean character width at that size
constexpr double kLegendMargin = 16.0;
constexpr double kSample = 24.0;
constexpr double kSampleGap = 8.0;
constexpr double kEntryGap = 24.0;
constexpr double kRow = 24.0;

double width_of(const LegendEntry& entry) {
  return kSample + kSampleGap + kCharacter * static_cast<double>(entry.meaning.size()) + kEntryGap;
}

PictureMark sample_of(const LegendEntry& entry, const Vector2d& left) {
  if (!entry.symbol) return PictureLine{{left, left + Vector2d(kSample, 0.0)}, entry.colour, 3.0, entry.stroke};
  PictureSymbols sample;
  sample.name = "legend";
  sample.symbol = *entry.symbol;
  sample.centres = {left + Vector2d(0.5 * kSample, 0.0)};
  sample.size = 9.0;
  sample.colour = entry.colour;
  return sample;
}

}  // namespace

Pane legend(const std::vector<LegendEntry>& entries, const std::string& note, int width) {
  Pane pane;
  pane.width = width;
  Vector2d at(kLegendMargin, kRow);
  for (const LegendEntry& entry : entries) {
    if (at.x() > kLegendMargin && at.x() + width_of(entry) - kEntryGap > width - kLegendMargin)
      at = {kLegendMargin, at.y() + kRow};
    pane.marks.emplace_back(sample_of(entry, at - Vector2d(0.0, 4.5)));
    pane.marks.emplace_back(
        PictureText{at + Vector2d(kSample + kSampleGap, 0.0), entry.meaning, kLegendTextSize, palette::kInk});
    at.x() += width_of(entry);
  }
  if (!note.empty()) {
    at.y() += kRow;
    pane.marks.emplace_back(PictureText{{kLegendMargin, at.y()}, note, kLegendTextSize - 1.0, palette::kFaint});
  }
  pane.height = static_cast<int>(std::lround(at.y() + 0.6 * kRow));
  return pane;
}

double round_length(double pixels_per_unit, double max_pixels) {
  const double most = max_pixels / pixels_per_unit;
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= most) return factor * power;
  }
  return power;
}

std::vector<PictureMark> scale_bar(const Vector2d& right_end, double pixels_per_unit, bool is_metric) {
  constexpr double kMax = 140.0, kTick = 5.0;
  const double length = round_length(pixels_per_unit, kMax);
  const Vector2d left = right_end - Vector2d(length * pixels_per_unit, 0.0);
  const Vector2d up(0.0, -kTick);
  const int decimals = length < 1.0 ? static_cast<int>(std::ceil(-std::log10(length) - 1e-9)) : 0;
  const std::string label = fmt::format("{:.{}f} {}", length, decimals, is_metric ? "m" : "map units");
  return {PictureLine{{left + up, left, right_end, right_end + up}, palette::kInk, 2.0},
          PictureText{left - Vector2d(kSampleGap, 0.0), label, kLegendTextSize, palette::kInk, Align::right}};
}

}  // namespace byre
