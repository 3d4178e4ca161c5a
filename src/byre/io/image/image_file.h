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

// Same as read_image and read_depth_image, with the reason of failure.
ImageReading<Image> try_image(const std::filesystem::path& path);
ImageReading<DepthImage> try_depth_image(const std::filesystem::path& path);

// Same for the bytes of such a file.
ImageReading<Image> decoded_image(const std::vector<std::uint8_t>& bytes);

// A PNG, JPEG or other common image file as 8-bit grey, not rotated by its EXIF tag. Empty if the file is missing, not
// an image, or truncated. 16-bit images are reduced to their upper byte.
std::optional<Image> read_image(const std::filesystem::path& path);

// A depth image: one channel of 16 bits. Empty if the file is missing, truncated or of another kind.
std::optional<DepthImage> read_depth_image(const std::filesystem::path& path);

}  // namespace byre
