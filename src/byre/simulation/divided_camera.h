#pragma once

#include "byre/calibration.h"

namespace byre {

// The same camera with divisor x divisor pixels made one; what is left over at the right and the bottom is lost.
Camera divided_camera(Camera camera, int divisor);

// The same camera with images of another size, pixels. The width shows as much as before; of the height what the shape
// allows, above and below alike.
Camera resized_camera(Camera camera, int width, int height);

}  // namespace byre
