#pragma once

#include "byre/calibration.h"
#include "byre/features.h"
#include "byre/frame_report.h"
#include "byre/image.h"
#include "byre/rig.h"

#include <array>
#include <cstddef>
#include <optional>

namespace byre {

struct InputCheckOptions {
  double max_pair_difference = 0.005;  // seconds between left and right image, or a picture and its depths
  double max_gap = 1.0;                // seconds between frames
};

// Looks at frames as they are handed over, one after the other, and counts what is wrong with them.
class InputCheck {
 public:
  // rig: that features are given in.
  InputCheck(const Calibration& calibration, const Rig& rig, const InputCheckOptions& options)
      : calibration_(calibration), rig_(rig), options_(options) {}

  InputFault note(const CameraImages& images);
  InputFault note(const Frame& frame);
  InputFault note(InputFault fault);  // fault that was found elsewhere

  InputFault last() const { return last_; }
  // Whether the right image or the depths of the images looked at last may be used.
  bool may_use_right() const { return is_right_sound_; }
  bool may_use_depth() const { return is_depth_sound_; }

  int frames() const { return frames_; }
  int frames(InputFault fault) const { return counts_[static_cast<std::size_t>(fault)]; }

 private:
  InputFault fault_of_right(const CameraImages& images) const;
  InputFault fault_of_depth(const CameraImages& images) const;
  InputFault fault_of_time(Timestamp time) const;
  InputFault fault_of(const Frame& frame) const;
  bool is_beside(const ImageView& view, const ImageView& left) const;

  // Constant after construction.
  Calibration calibration_;
  Rig rig_;
  InputCheckOptions options_;

  std::optional<Timestamp> last_time_;  // time of the last frame that was not dropped
  InputFault last_ = InputFault::none;
  bool is_right_sound_ = false;
  bool is_depth_sound_ = false;
  int frames_ = 0;
  std::array<int, static_cast<std::size_t>(InputFault::after_finishing) + 1> counts_{};
};

}  // namespace byre
