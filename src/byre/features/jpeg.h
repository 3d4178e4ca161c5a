#pragma once

#include "byre/image.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace byre {

// JPEG file of a grey image, of quality 75, or of the highest lower quality with at most max_bytes. Empty if none is
// small enough, or a side is not between 1 and 65500 pixels.
std::vector<std::byte> encode_jpeg(const Image& image, std::size_t max_bytes);

// Grey image of a JPEG file. Empty for damage, and for sides above 1024 pixels.
std::optional<Image> decode_jpeg(std::span<const std::byte> jpeg);

}  // namespace byre
