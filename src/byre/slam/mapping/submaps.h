#pragma once

#include "byre/map/ids.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace byre {

// Submaps of an online map, each tracked without a gap, in order of their begin, with their coordinate frames. Poses
// are comparable within one frame. The map frame is that of reported poses: the offline map's, if there is one.
class Submaps {
 public:
  using Frame = int;
  static constexpr Frame kMapFrame = 0;

  bool empty() const { return submaps_.empty(); }
  std::size_t size() const { return submaps_.size(); }
  // The present submap is the last one. Precondition: not empty.
  std::size_t present() const { return submaps_.size() - 1; }
  Frame frame() const { return submaps_.back().frame; }
  Frame frame(std::size_t submap) const { return submaps_[submap].frame; }
  Frame frame(KeyframeId online) const;
  // Whether the present submap lies in the map frame.
  bool is_registered() const { return !empty() && frame() == kMapFrame; }
  // Whether a submap lies in a frame of its own.
  bool has_separate() const;
  // Whether the keyframe lies in the frame of the present submap.
  bool is_in_present_frame(KeyframeId online) const { return frame(online) == frame(); }

  // Begin a new submap. first_keyframe: number of its first keyframe.
  void begin_in_map_frame(std::uint32_t first_keyframe);
  void begin_in_own_frame(std::uint32_t first_keyframe);
  // Begins a submap in the frame of an older keyframe, at which the camera was relocalised.
  void begin_in_frame_of(KeyframeId online, std::uint32_t first_keyframe);

  // The contents of a frame were registered and moved to the map frame.
  void join_map_frame(Frame frame);
  // Gives the present submap from this keyframe on a frame of its own: it was registered to the map frame wrongly. The
  // part before becomes a submap that stays.
  void leave_map_frame(std::uint32_t first_keyframe);

 private:
  struct Submap {
    std::uint32_t first_keyframe = 0;
    Frame frame = kMapFrame;
  };

  std::vector<Submap> submaps_;
  Frame next_frame_ = kMapFrame + 1;
};

}  // namespace byre
