#pragma once

#include "byre/image.h"

namespace byre {

// Scales the image to cover the size, and crops it about its centre.
Image resize_to_cover(const Image& image, int width, int height);

}  // namespace byre
