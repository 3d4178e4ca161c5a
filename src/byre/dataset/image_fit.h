#pragma once

#include "byre/image.h"

namespace byre {

// Scales the image to cover the size, and crops it about its centre.
Image fit(const Image& image, int width, int height);

}  // namespace byre
