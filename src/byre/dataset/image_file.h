#pragma once

#include "byre/image.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// What came of reading an image file.
template <typename AnyImage>
struct ImageReading {
  std::optional<AnyImage> image;
  std::string failure;  // why there is none, to be told behind the name of the file: "is not a whole image"
};

// As read_image and read_depth_image below.
ImageReading<Image> try_image(const std::filesystem::path& path);
ImageReading<DepthImage> try_depth_image(const std::filesystem::path& path);

// What the bytes of such a file hold.
ImageReading<Image> decoded_image(const std::vector<std::uint8_t>& bytes);

// A PNG, JPEG or other common image file as 8-bit grey, not turned by its EXIF tag. Empty when the file is missing,
// no image, or cut short. Of 16-bit images the upper byte is taken.
std::optional<Image> read_image(const std::filesystem::path& path);

// A depth image: one channel of 16 bits. Empty when the file is missing, cut short or anything else.
std::optional<DepthImage> read_depth_image(const std::filesystem::path& path);

}  // namespace byre
