#pragma once

#include "byre/image.h"

#include <cstdint>
#include <vector>

namespace byre {

// A PNG file of the image, made fast rather than small.
std::vector<std::uint8_t> png_of(const Image& image);

// Both beside one another. Precondition: they are of one height.
Image side_by_side(const Image& left, const Image& right);

}  // namespace byre
