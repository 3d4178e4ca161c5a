#include "byre/simulation/downscaled_camera.h"

namespace byre {
namespace {

// u of a pixel centre after binning by divisor: the image border at -0.5 stays fixed.
double downscaled_centre(double centre, double divisor) {
  return (centre + 0.5) / divisor - 0.5;
}

}  // namespace

Camera downscaled_camera(Camera camera, int divisor) {
  camera.width /= divisor;
  camera.height /= divisor;
  camera.fx /= divisor;
  camera.fy /= divisor;
  camera.cx = downscaled_centre(camera.cx, divisor);
  camera.cy = downscaled_centre(camera.cy, divisor);
  return camera;
}

Camera resized_camera(Camera camera, int width, int height) {
  const double divisor = static_cast<double>(camera.width) / width;
  const double lost = 0.5 * (camera.height / divisor - height);  // rows cut off above, at the new size
  camera.fx /= divisor;
  camera.fy /= divisor;
  camera.cx = downscaled_centre(camera.cx, divisor);
  camera.cy = downscaled_centre(camera.cy, divisor) - lost;
  camera.width = width;
  camera.height = height;
  return camera;
}

}  // namespace byre
