#pragma once

namespace byre {

// What was left out of a frame so that it keeps to its deadline, see the option frame.deadline_ms.
struct FrameCuts {
  // Fewer points of the session's own map were looked for: none where points of an offline map hold the pose.
  bool online_points = false;
  bool right_image = false;  // the frame was tracked by its left image alone
};

}  // namespace byre
