#pragma once

#include "byre/image.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Result of reading an image file.
template <typename AnyImage>
struct ImageReading {
  std::optional<AnyImage> image;
  std::string failure;  // reason of failure, to follow the name of the file: "is not a complete image"
};

// Bits in use of the 16 bits of a pixel: cameras of 10, 12 or 14 bits often store their values in the lower bits.
inline constexpr int kWordBits = 16;

// The least of 8, 10, 12, 14 and 16 bits that hold a value.
int bits_of(std::uint16_t value);

// Largest value of a PNG of 16-bit grey; empty for other files.
std::optional<std::uint16_t> largest_value(const std::filesystem::path& path);

// Same as read_image and read_depth_image, with the reason of failure. bits: bits in use of 16-bit grey images.
ImageReading<Image> try_image(const std::filesystem::path& path, int bits = kWordBits);
ImageReading<DepthImage> try_depth_image(const std::filesystem::path& path);

// Same for the bytes of such a file.
ImageReading<Image> decoded_image(const std::vector<std::uint8_t>& bytes, int bits = kWordBits);

// A PNG, JPEG or other common image file as 8-bit grey, not rotated by its EXIF tag. Empty if the file is missing, not
// an image, or truncated. 16-bit images are reduced to their upper byte.
std::optional<Image> read_image(const std::filesystem::path& path);

// Depth image in the bytes of a file, or the reason of failure.
ImageReading<DepthImage> decoded_depth_image(const std::vector<std::uint8_t>& bytes);

// A depth image: one channel of 16 bits. Empty if the file is missing, truncated or of another kind.
std::optional<DepthImage> read_depth_image(const std::filesystem::path& path);

// Scales the image to cover the size, and crops it about its centre.
Image resize_to_cover(const Image& image, int width, int height);

}  // namespace byre
