#include "byre/slam/mapping/submaps.h"

#include <algorithm>
#include <iterator>

namespace byre {

// Submaps with an equal first_keyframe are empty, except for the last one.
Submaps::Frame Submaps::frame(KeyframeId online) const {
  const auto next = std::ranges::upper_bound(submaps_, online.number, {}, &Submap::first_keyframe);
  return std::prev(next)->frame;
}

bool Submaps::has_separate() const {
  return std::ranges::any_of(submaps_, [](const Submap& submap) { return submap.frame != kMapFrame; });
}

void Submaps::begin_in_map_frame(std::uint32_t first_keyframe) {
  submaps_.push_back({first_keyframe, kMapFrame});
}

void Submaps::begin_in_own_frame(std::uint32_t first_keyframe) {
  submaps_.push_back({first_keyframe, next_frame_++});
}

void Submaps::begin_in_frame_of(KeyframeId online, std::uint32_t first_keyframe) {
  submaps_.push_back({first_keyframe, frame(online)});
}

void Submaps::leave_map_frame(std::uint32_t first_keyframe) {
  if (first_keyframe > submaps_.back().first_keyframe) submaps_.push_back({first_keyframe, kMapFrame});
  submaps_.back().frame = next_frame_++;
}

void Submaps::join_map_frame(Frame frame) {
  for (Submap& submap : submaps_) {
    if (submap.frame == frame) submap.frame = kMapFrame;
  }
}

}  // namespace byre
