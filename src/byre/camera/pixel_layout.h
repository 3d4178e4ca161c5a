#pragma once

#include "byre/image.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace byre {

// Memory layout of a captured image. code: four-character format code of V4L2.
struct PixelLayout {
  std::uint32_t code = 0;
  int width = 0;           // pixels
  int height = 0;          // pixels
  std::size_t stride = 0;  // bytes from one row to the next; unused for compressed images
};

// Code as text, such as "YUYV".
std::string four_characters(std::uint32_t code);
// Empty unless the text has one to four characters.
std::optional<std::uint32_t> parse_four_characters(const std::string& text);

bool is_readable(std::uint32_t code);
// All readable formats in order of preference, separated by commas.
std::string readable_formats();
// Rank in that order: the fewest bytes with all grey values come first. Empty for unreadable formats.
std::optional<int> preference_of(std::uint32_t code);

// The image as 8-bit grey; of more bits the upper ones. Empty if bytes are missing, or compressed bytes are not a whole
// image of that size. Precondition: the format is readable.
std::optional<Image> grey_of(const PixelLayout& layout, std::span<const std::uint8_t> bytes);

// Left and right half of an image that contains both. The width must be even.
struct ImageHalves {
  Image left;
  Image right;
};
ImageHalves halves_of(const Image& both);

}  // namespace byre
