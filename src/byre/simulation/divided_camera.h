#pragma once

#include "byre/calibration.h"

namespace byre {

// The same camera with divisor x divisor pixels made one; what is left over at the right and the bottom is lost.
Camera divided_camera(Camera camera, int divisor);

// The same camera with images of another size, in pixels. The horizontal field of view stays; the vertical one grows or
// shrinks with the height, above and below alike.
Camera resized_camera(Camera camera, int width, int height);

}  // namespace byre
