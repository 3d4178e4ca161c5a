#pragma once

#include "byre/viewer/scene.h"

#include <mutex>
#include <optional>
#include <vector>

namespace byre {

// The report of a frame, and what there was of the online map then.
struct ShownFrame {
  FrameReport report;
  int online_keyframes = 0;
  int online_points = 0;
};

// Where the thread of a run leaves what there is to show, without waiting: reports gather, as they are small, and of
// images and maps the newest takes the place of one that nobody has taken yet. May be used from two threads.
class RunMailbox {
 public:
  struct Content {
    std::vector<ShownFrame> frames;
    std::optional<FrameScene> newest;  // scene of the newest of these frames; left is as recorded, not rectified
    std::optional<MapScene> online;
    bool has_ended = false;  // no more frames will come
  };

  void put(ShownFrame frame, FrameScene scene);
  void put(MapScene online);
  void put_end();

  // All there is, and leaves the mailbox empty.
  Content take();

 private:
  std::mutex mutex_;
  Content content_;  // guarded by the mutex
};

}  // namespace byre
