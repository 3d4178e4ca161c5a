#pragma once

#include "byre/image.h"

#include <cstdint>
#include <functional>

namespace byre {

// What may go wrong before or in a camera, done to images as they were recorded. The same image, options and seed give
// the same bytes.

// What a camera gives without light: its black level, and a little noise.
Image without_light(const Image& image, std::uint64_t seed);

// Moved by so many pixels while the shutter was open. The angle is that of the motion, radians from the u axis.
Image motion_blurred(const Image& image, double pixels, double angle);

// Exposed so many times as long; what is brighter than white is white.
Image exposed(const Image& image, double times);

// Seen through haze that lets through this share of the light, and shines itself.
Image hazed(const Image& image, double transmission);

// Grey values drawn together about their mean, to this share of their contrast.
Image flattened(const Image& image, double share);

// Through a lens with spots of dirt on it, all out of focus. They lie where the seed says, frame after frame.
Image dirtied(const Image& image, int spots, std::uint64_t seed);

// A bright wall without texture right before the camera: shading and faint noise. The noise differs between seeds.
Image blank_wall(const Image& image, std::uint64_t seed);

// What happens to the images of a rig, step by step from the frame it begins with (step 0).
using Degradation = std::function<ImageFrame(const ImageFrame& images, int step)>;

Degradation black_frames();

// A hand comes before both lenses within five steps, and rests there, covering this share of the left image: softly
// edged, with a little of the skin's texture, and further left in the right image.
Degradation hand_over_the_lens(double coverage);

Degradation motion_blur(double pixels);                          // in ever another direction
Degradation exposure_jumps(double factor, int steps_per_level);  // longer, as it was, shorter, as it was, ...
Degradation blank_close_up();
Degradation haze(double transmission);
Degradation dirt(int spots);  // other ones on each lens
Degradation contrast_loss(double share);

// Cameras that lie. Those that remember images are for one run, step by step.
Degradation frozen(double sigma = 0.0);   // repeats the image of step 0, with fresh noise (grey values)
Degradation right_exposed(double times);  // 0: dead
Degradation right_noisy(double sigma);    // grey values
Degradation right_late(int steps);        // the right image is late by a number of steps
Degradation left_late(int steps);         // the left image is late by a number of steps
Degradation swapped();                    // left for right
Degradation mirrored();                   // left to right
Degradation upside_down();

}  // namespace byre
