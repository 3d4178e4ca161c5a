#pragma once

#include "byre/image.h"

#include <cstdint>
#include <vector>

namespace byre {

// A PNG file of the image, optimised for speed rather than size.
std::vector<std::uint8_t> png_of(const Image& image);

// Both images side by side. Precondition: equal heights.
Image side_by_side(const Image& left, const Image& right);

}  // namespace byre
