#include "byre/mapping/segments.h"

#include <algorithm>
#include <iterator>

namespace byre {

// Where segments begin with the same number the last one has the keyframes: those before never got any.
Segments::Frame Segments::frame(KeyframeId online) const {
  const auto next = std::ranges::upper_bound(segments_, online.number, {}, &Segment::first_keyframe);
  return std::prev(next)->frame;
}

void Segments::begin_in_map_frame(std::uint32_t first_keyframe) {
  segments_.push_back({first_keyframe, kMapFrame});
}

void Segments::begin_in_own_frame(std::uint32_t first_keyframe) {
  segments_.push_back({first_keyframe, next_frame_++});
}

void Segments::begin_beside(KeyframeId online, std::uint32_t first_keyframe) {
  segments_.push_back({first_keyframe, frame(online)});
}

void Segments::join_map_frame(Frame frame) {
  for (Segment& segment : segments_) {
    if (segment.frame == frame) segment.frame = kMapFrame;
  }
}

}  // namespace byre
