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
  double max_pair_difference = 0.005;  // seconds between left and right or depth image
  double max_gap = 1.0;                // seconds between frames
};

// Detects and counts faults of consecutive frames.
class InputCheck {
 public:
  // rig: camera of the caller's features.
  InputCheck(const Calibration& calibration, const Rig& rig, const InputCheckOptions& options)
      : calibration_(calibration), rig_(rig), options_(options) {}

  InputFault note(const CameraImages& images);
  InputFault note(const Frame& frame);
  InputFault note(InputFault fault);  // fault detected elsewhere

  InputFault last() const { return last_; }
  // Whether right image and depths of the last frame are usable.
  bool may_use_right() const { return is_right_valid_; }
  bool may_use_depth() const { return is_depth_valid_; }

  int frames() const { return frames_; }
  int frames(InputFault fault) const { return counts_[static_cast<std::size_t>(fault)]; }

 private:
  InputFault fault_of_right(const CameraImages& images) const;
  InputFault fault_of_depth(const CameraImages& images) const;
  InputFault fault_of_time(Timestamp time) const;
  InputFault fault_of(const Frame& frame) const;
  bool is_simultaneous(const ImageView& view, const ImageView& left) const;

  // Constant after construction.
  Calibration calibration_;
  Rig rig_;
  InputCheckOptions options_;

  std::optional<Timestamp> last_time_;  // time of the last frame not dropped
  InputFault last_ = InputFault::none;
  bool is_right_valid_ = false;
  bool is_depth_valid_ = false;
  int frames_ = 0;
  std::array<int, static_cast<std::size_t>(InputFault::after_finishing) + 1> counts_{};
};

}  // namespace byre
