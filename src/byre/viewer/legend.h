#pragma once

#include "byre/viewer/picture.h"

#include <optional>
#include <string>
#include <vector>

namespace byre {

// What a sign in a picture means.
struct LegendEntry {
  std::string meaning;
  Colour colour;
  std::optional<Symbol> symbol{};  // a symbol, or else
  Stroke stroke = Stroke::solid;   // a line
};

// Entries one after the other, in as many rows as the width takes; a note of one line goes below them unless empty.
Pane legend(const std::vector<LegendEntry>& entries, const std::string& note, int width);

// A bar of a round length that ends there, with the length at its left. An unknown scale is in units of the map.
std::vector<PictureMark> scale_bar(const Eigen::Vector2d& right_end, double pixels_per_unit, bool is_metric);

// The length of a bar of at most so many pixels: 1, 2 or 5 times a power of ten.
double round_length(double pixels_per_unit, double most_pixels);

}  // namespace byre
