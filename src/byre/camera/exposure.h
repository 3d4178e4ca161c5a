#pragma once

#include "byre/image.h"

namespace byre {

// How much light a camera takes: exposure time, and by how much what it gives is amplified.
struct CameraExposure {
  double seconds = 0.0;
  double gain = 1.0;  // factor, one for none

  double light() const { return seconds * gain; }
};

struct CameraExposureLimits {
  double min_seconds = 1e-4;
  double max_seconds = 5e-3;  // longer ones blur what moves
  double max_gain = 1.0;      // factor
};

// How much of a scene's corners an image would show if it had taken so many times the light: gradients between pixels
// as they then would be, each counted by the curve of Shim, Lee and Kweon 2014 ("Auto-adjusting camera exposure for
// outdoor robotics using gradient information"), summed within the cells of a grid. Pixels follow the light until they
// are full, as in Zhang, Forster and Scaramuzza 2017 ("Active exposure control for robust visual odometry in HDR
// environments"); one that is full now may be as full with less. A cell counts by the logarithm, so that corners all
// over the image count for more than many in one place.
double corner_information(const Image& image, double factor);

// How many times the light an image would show most with, of some factors that are tried. Of an image that shows
// nothing at all it tells whether that is for too much light or too little.
double best_light_factor(const Image& image);

// What to take next after an image taken so has that best factor: a part of the way, at most a factor of two, so that
// it settles. Time comes first, up to its limit; the gain makes up for the rest.
CameraExposure next_exposure(const CameraExposure& now, double factor, const CameraExposureLimits& limits);

}  // namespace byre
