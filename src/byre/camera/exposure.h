#pragma once

#include "byre/image.h"

namespace byre {

// How much light a camera takes: exposure time, and by how much what it gives is amplified.
struct Exposure {
  double seconds = 0.0;
  double gain = 1.0;  // factor, one for none

  double light() const { return seconds * gain; }
};

struct ExposureLimits {
  double min_seconds = 1e-4;
  double max_seconds = 5e-3;  // longer ones blur what moves
  double max_gain = 1.0;      // factor
};

// How much of a scene's corners an image shows, if it were as much brighter or darker as a gamma makes it: gradients
// of the image put through that curve (Shim, Lee and Kweon 2014, "Auto-adjusting camera exposure for outdoor robotics
// using gradient information"), summed within the cells of a grid. A cell counts by the logarithm, so that corners all
// over the image count for more than many in one place. Gamma below one is brighter.
double gradient_information(const Image& image, double gamma);

// The gamma at which an image would show most, of several that are tried; above one where it is too bright. Of an image
// that shows nothing at all it tells whether that is for too much light or too little.
double best_gamma(const Image& image);

// What to take next after an image taken so has that best gamma. The light follows the gamma, in steps of at most a
// factor of two. Time comes first, up to its limit; the gain makes up for the rest.
Exposure next_exposure(const Exposure& now, double gamma, const ExposureLimits& limits);

}  // namespace byre
