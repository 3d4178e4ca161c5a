#pragma once

#include "byre/features/image.h"

#include <filesystem>
#include <optional>

namespace byre {

// A PNG, JPEG or other common image file as 8-bit grey, not turned by its EXIF tag. Empty when the file is missing,
// no image, or cut short. Of 16-bit images the upper byte is taken.
std::optional<Image> read_image(const std::filesystem::path& path);

// A depth image: one channel of 16 bits. Empty when the file is missing, cut short or anything else.
std::optional<DepthImage> read_depth_image(const std::filesystem::path& path);

}  // namespace byre
