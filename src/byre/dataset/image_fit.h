#pragma once

#include "byre/image.h"

namespace byre {

// The image scaled until it covers the size, and cut to it about its centre.
Image fit(const Image& image, int width, int height);

}  // namespace byre
