#pragma once

#include "byre/calibration.h"
#include "byre/features.h"
#include "byre/frame_report.h"
#include "byre/image.h"

#include <array>
#include <optional>

namespace byre {

struct InputCheckOptions {
  double max_pair_difference = 0.005;  // seconds between left and right image
  double max_gap = 1.0;                // seconds between frames
};

// Looks at frames as they are handed over, one after the other, and counts what is wrong with them.
class InputCheck {
 public:
  InputCheck(const Calibration& calibration, const InputCheckOptions& options)
      : calibration_(calibration), options_(options) {}

  InputFault note(const CameraImages& images);
  InputFault note(const Frame& frame);
  InputFault note(InputFault fault);  // that was found elsewhere

  InputFault last() const { return last_; }
  int frames() const { return frames_; }
  int frames(InputFault fault) const { return counts_[static_cast<std::size_t>(fault)]; }

 private:
  InputFault fault_of(const CameraImages& images) const;
  InputFault fault_of_time(Timestamp time) const;

  Calibration calibration_;             // constant after construction
  InputCheckOptions options_;           // likewise
  std::optional<Timestamp> last_time_;  // of a frame that was not dropped
  InputFault last_ = InputFault::none;
  int frames_ = 0;
  std::array<int, static_cast<std::size_t>(InputFault::after_finishing) + 1> counts_{};
};

}  // namespace byre
