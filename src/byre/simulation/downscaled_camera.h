#pragma once

#include "byre/calibration.h"

namespace byre {

// The camera after binning of divisor x divisor pixels; remaining columns and rows at the right and bottom are cut off.
Camera downscaled_camera(Camera camera, int divisor);

// The camera with another image size, in pixels. The horizontal field of view is kept; the vertical one is cropped or
// extended equally above and below.
Camera resized_camera(Camera camera, int width, int height);

}  // namespace byre
