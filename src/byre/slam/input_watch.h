#pragma once

#include "byre/features/stereo_fit.h"

#include <optional>

namespace byre {

// What speaks against the images of a frame themselves.
struct InputEvidence {
  bool is_repeated = false;                   // the image is the last one again, bit by bit
  double frozen_seconds = 0.0;                // seconds for which the image has been the same
  ImageFault right_fault = ImageFault::none;  // fault of the right image, where the left one has none
  // The right image hardly shows what the left one does, or on other rows; not where dirt hides much of it.
  bool cameras_disagree = false;
};

// Looks at frames one after the other.
class InputWatch {
 public:
  explicit InputWatch(const ImageConditionOptions& image);

  // Rows are judged by the calibration that the frame's features were made, or made anew, by.
  InputEvidence look_at(const Frame& frame, const Rig& rig);

 private:
  void note_repetition(const Frame& frame, InputEvidence& evidence);
  void note_pair(const Frame& frame, const Rig& rig, InputEvidence& evidence);

  ImageConditionOptions image_;  // constant after construction
  std::uint64_t last_content_ = 0;
  Timestamp first_shown_{};  // when the present image came first
  std::optional<double> matched_;
  std::optional<double> row_error_;  // pixels
  MatchedByPart by_part_;
};

}  // namespace byre
