#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace byre {

std::vector<std::uint8_t> png_signature();  // the first bytes of a file

bool is_png(std::span<const std::uint8_t> bytes);

// A chunk of a PNG file (PNG specification, section 5).
struct PngChunk {
  std::span<const std::uint8_t> bytes;  // length, type, data, checksum

  std::string_view type() const { return {reinterpret_cast<const char*>(bytes.data()) + 4, 4}; }  // four letters
  std::span<const std::uint8_t> data() const { return bytes.subspan(8, bytes.size() - 12); }
};

// The chunks up to the last one; empty if the file is truncated or damaged. They refer to the bytes. Precondition:
// is_png(bytes).
std::optional<std::vector<PngChunk>> png_chunks(std::span<const std::uint8_t> bytes);

// A PNG file with only the chunks that pixels need. For unsuitable profiles and similar chunks the decoder would print
// warnings on the standard error stream.
std::vector<std::uint8_t> png_of_pixels(std::span<const PngChunk> chunks);

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
