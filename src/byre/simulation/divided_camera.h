#pragma once

#include "byre/calibration.h"

namespace byre {

// The same camera with divisor x divisor pixels made one; what is left over at the right and the bottom is lost.
Camera divided_camera(Camera camera, int divisor);

}  // namespace byre
