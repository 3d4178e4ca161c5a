#pragma once

#include "byre/calibration.h"
#include "byre/viewer/picture.h"

#include <string>

namespace byre {

// Lens distortion and rectification of each camera, drawn twice. Above: a regular grid of pixels of the ideal camera as
// it appears in the image. Below: a regular grid of pixels of the image as it appears to the ideal camera. Axes count
// pixels; labels at the sides are angles off the optical axis. Cameras without a common rectification have an ideal
// camera each. Precondition: the image sizes are known.
Picture calibration_picture(const Calibration& calibration, const std::string& title);

}  // namespace byre
