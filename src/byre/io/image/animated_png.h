#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace byre {

// Times of an animation, milliseconds.
struct AnimationTimes {
  std::uint16_t frame_ms = 125;
  std::uint16_t last_frame_ms = 2000;
};

// An animated PNG file that repeats for ever (PNG specification 3, section 11.3.6), of BGR frames of equal size.
// Colours are rounded to the 255 most frequent ones of five bits a channel. Differences of at most 9 grey values from
// the left neighbour are dropped. Each later frame stores only the rectangle of changed pixels. Precondition: at least
// one frame.
std::vector<std::uint8_t> encode_animated_png(const std::vector<cv::Mat>& frames, const AnimationTimes& times);

}  // namespace byre
