#pragma once

#include "byre/viewer/picture.h"

#include <optional>
#include <string>
#include <vector>

namespace byre {

// Symbol or line of a picture, with its meaning.
struct LegendEntry {
  std::string meaning;
  Colour colour;
  std::optional<Symbol> symbol{};  // empty: a line
  Stroke stroke = Stroke::solid;   // stroke of the line
};

// Entries in rows of the given width; below them a one-line note unless empty.
Pane legend(const std::vector<LegendEntry>& entries, const std::string& note, int width);

// Scale bar of a round length with its right end at a point, labelled on the left. Without metric scale in map units.
std::vector<PictureMark> scale_bar(const Eigen::Vector2d& right_end, double pixels_per_unit, bool is_metric);

// Length of a bar of at most max_pixels: 1, 2 or 5 times a power of ten.
double round_length(double pixels_per_unit, double max_pixels);

}  // namespace byre
