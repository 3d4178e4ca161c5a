#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace byre {

// Grey values as a PNG file holds them, row after row.
struct GreyPng {
  int width = 0;
  int height = 0;
  int bytes_a_pixel = 1;             // 2: the more significant one first
  std::vector<std::uint8_t> values;  // width * height * bytes_a_pixel
};

// Decodes what cameras write: 8 or 16 bits of grey, neither interlaced nor transparent (PNG specification, sections 7
// to 10). In a third of the time that decoders of all kinds take. Empty for any other kind and for what is damaged:
// their matter. Precondition: a file as png_of_pixels leaves it, of at most kMostPixels.
std::optional<GreyPng> decode_grey_png(std::span<const std::uint8_t> png);

}  // namespace byre
