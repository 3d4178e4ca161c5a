#pragma once

#include "byre/map/ids.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace byre {

// The submaps of an online map, each tracked without a gap, in the order in which they were begun, and the frames they
// lie in. Poses can be compared where the frame is the same. One frame is that of the reports: the offline map's where
// there is one.
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
  // The present submap lies in the reports' frame.
  bool is_registered() const { return !empty() && frame() == kMapFrame; }
  // The keyframe lies in the frame of the present submap.
  bool is_in_present_frame(KeyframeId online) const { return frame(online) == frame(); }

  // A new submap, whose keyframes will have this number and higher ones.
  void begin_in_map_frame(std::uint32_t first_keyframe);
  void begin_in_own_frame(std::uint32_t first_keyframe);
  // One that goes on where an older keyframe was found.
  void begin_beside(KeyframeId online, std::uint32_t first_keyframe);

  // It became known how a frame lies in the map's: what lies in it was moved there.
  void join_map_frame(Frame frame);
  // The present submap does not lie in the map's frame as was believed; nobody knows how it does.
  void leave_map_frame() { submaps_.back().frame = next_frame_++; }

 private:
  struct Submap {
    std::uint32_t first_keyframe = 0;
    Frame frame = kMapFrame;
  };

  std::vector<Submap> submaps_;
  Frame next_frame_ = kMapFrame + 1;
};

}  // namespace byre
