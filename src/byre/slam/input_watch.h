#pragma once

#include "byre/features.h"
#include "byre/features/stereo_fit.h"

#include <optional>

namespace byre {

struct InputWatchOptions {
  ImageConditionOptions image;
  int min_features = 100;  // of a frame whose pair is judged
  double min_matched = kLeastStereoShare;
  double max_row_error = kMostRowOffset;  // pixels
  double memory = 0.7;                    // of both, from frame to frame
};

// What speaks against the images of a frame themselves.
struct InputEvidence {
  bool is_repeated = false;                   // the image is the last one again, bit by bit
  double frozen_seconds = 0.0;                // for so long
  ImageFault right_fault = ImageFault::none;  // of the right image, where the left one has none
  bool cameras_disagree = false;              // the right image hardly shows what the left one does, or on other rows
};

// Looks at frames one after the other.
class InputWatch {
 public:
  explicit InputWatch(const InputWatchOptions& options) : options_(options) {}

  // Rows are judged by the calibration that the frame's features were made, or made anew, by.
  InputEvidence look_at(const Frame& frame);

 private:
  void note_repetition(const Frame& frame, InputEvidence& evidence);
  void note_pair(const Frame& frame, InputEvidence& evidence);

  InputWatchOptions options_;
  std::uint64_t last_content_ = 0;
  Timestamp first_shown_{};  // when the present image came first
  std::optional<double> matched_;
  std::optional<double> row_error_;  // pixels
};

}  // namespace byre
