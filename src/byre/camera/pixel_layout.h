#pragma once

#include "byre/image.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace byre {

// How the bytes of a captured image lie. code: the four characters by which V4L2 names a format.
struct PixelLayout {
  std::uint32_t code = 0;
  int width = 0;           // pixels
  int height = 0;          // pixels
  std::size_t stride = 0;  // bytes from one row to the next; of no meaning where images are compressed
};

// "YUYV".
std::string four_characters(std::uint32_t code);
// Empty for a text that is not of one to four characters.
std::optional<std::uint32_t> parse_four_characters(const std::string& text);

// Whether images of that format can be taken.
bool is_readable(std::uint32_t code);
// All that can be, in the order in which they are preferred, separated by commas.
std::string readable_formats();
// The place in that order; the fewest bytes that hold all grey values come first. Empty for what cannot be read.
std::optional<int> preference_of(std::uint32_t code);

// The image as 8-bit grey; of more bits the upper ones. Empty where bytes are missing, or compressed ones are no whole
// image of that size. Precondition: the format is readable.
std::optional<Image> grey_of(const PixelLayout& layout, std::span<const std::uint8_t> bytes);

// The left and the right half of an image that holds both. The width must be even.
struct ImageHalves {
  Image left;
  Image right;
};
ImageHalves halves_of(const Image& both);

}  // namespace byre
