#pragma once

#include "byre/viewer/scene.h"

#include <mutex>
#include <optional>
#include <vector>

namespace byre {

// Report of a frame, with the size of the online map at that time.
struct ShownFrame {
  FrameReport report;
  int online_keyframes = 0;
  int online_points = 0;
};

// Mailbox from the thread of a run to the viewer's thread; put() never waits. Reports accumulate; of images and maps
// only the newest is held. Thread-safe.
class RunMailbox {
 public:
  struct Content {
    std::vector<ShownFrame> frames;
    std::optional<FrameScene> newest;  // scene of the newest of these frames; the left image is not rectified
    std::optional<MapScene> online;
    bool has_ended = false;  // no more frames follow
  };

  void put(ShownFrame frame, FrameScene scene);
  void put(MapScene online);
  void put_end();

  // Removes and returns all content.
  Content take();

 private:
  std::mutex mutex_;
  Content content_;  // guarded by the mutex
};

}  // namespace byre
