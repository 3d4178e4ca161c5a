#pragma once

#include "byre/io/image/png_chunks.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace byre {

// Grey values as stored in a PNG file, row by row.
struct GreyPng {
  int width = 0;
  int height = 0;
  int bytes_a_pixel = 1;             // 2: most significant byte first
  std::vector<std::uint8_t> values;  // width * height * bytes_a_pixel
};

// Decodes PNG files as written by cameras: 8 or 16 bits of grey, neither interlaced nor transparent (PNG specification,
// sections 7 to 10), with two thirds of the instructions of OpenCV's decoder. Empty for other kinds and for damaged
// files, which are left to OpenCV. Precondition: the file states at most kMaxPixels.
std::optional<GreyPng> decode_grey_png(std::span<const PngChunk> chunks);

}  // namespace byre
