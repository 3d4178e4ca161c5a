#pragma once

#include "byre/image.h"

#include <cstdint>
#include <functional>

namespace byre {

// Simulated faults in front of or inside a camera, applied to recorded images. Deterministic in image, options and
// seed.

// A dark frame: the camera's black level and little noise.
Image without_light(const Image& image, std::uint64_t seed);

// Motion blur over a distance in pixels. angle: direction of motion, radians from the u axis.
Image motion_blurred(const Image& image, double pixels, double angle);

// Exposure time multiplied by times; saturates at white.
Image exposed(const Image& image, double times);

// Haze with this transmission; it adds its own light.
Image hazed(const Image& image, double transmission);

// Contrast reduced to this share about the mean grey value.
Image flattened(const Image& image, double share);

// Dirt on the lens: spots out of focus, at positions that depend on the seed only.
Image dirtied(const Image& image, int spots, std::uint64_t seed);

// A bright wall without texture close to the camera: shading and faint noise that depends on the seed.
Image blank_wall(const Image& image, std::uint64_t seed);

// A fault over time: called for each frame, step 0 is the first.
using Degradation = std::function<ImageFrame(const ImageFrame& images, int step)>;

Degradation black_frames();

// A hand covers both lenses within five steps and stays: this share of the left image, further left in the right one.
// Its edge is soft and its skin has faint texture.
Degradation hand_over_the_lens(double coverage);

Degradation motion_blur(double pixels);                          // in a different direction each step
Degradation exposure_jumps(double factor, int steps_per_level);  // alternates longer, normal, shorter, normal, ...
Degradation blank_close_up();
Degradation haze(double transmission);
Degradation dirt(int spots);  // different spots on each lens
Degradation contrast_loss(double share);

// Sensor faults: images that are not what they claim to be. Stateful ones are for one run, step by step.
Degradation frozen(double sigma = 0.0);   // repeats the image of step 0 with fresh noise (sigma in grey values)
Degradation right_exposed(double times);  // 0: dead
Degradation right_noisy(double sigma);    // sigma in grey values
Degradation right_late(int steps);
Degradation left_late(int steps);
Degradation swapped();   // exchanges left and right image
Degradation mirrored();  // mirrors images horizontally
Degradation upside_down();

}  // namespace byre
