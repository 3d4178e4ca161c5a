#pragma once

namespace byre {

// Work skipped in a frame to keep its deadline (option frame.deadline_ms).
struct FrameCuts {
  // Fewer online points were searched; none while offline points support the pose.
  bool online_points = false;
  bool right_image = false;  // the right image was skipped
};

}  // namespace byre
