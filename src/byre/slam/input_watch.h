#pragma once

#include "byre/features/stereo_fit.h"
#include "byre/slam/pair_timing.h"
#include "byre/slam/still_image.h"

#include <optional>

namespace byre {

// Evidence against the images of a frame themselves.
struct InputEvidence {
  bool is_repeated = false;                   // the image is the last one again, bit by bit
  bool is_still = false;                      // the image is at standstill: it cannot show whether it is frozen
  bool is_frozen = false;                     // the image is at standstill although the camera moves
  double frozen_seconds = 0.0;                // time for which the image has been repeated or frozen
  ImageFault right_fault = ImageFault::none;  // fault of the right image, where the left one has none
  // The right image hardly shows what the left one does, or on other rows; not where dirt hides much of it.
  bool cameras_disagree = false;
  Sign out_of_step = Sign::unclear;  // one image of the pair is older than the other
};

// Known motion up to a frame.
struct KnownMotion {
  std::optional<BodyMotion> measured{};  // motion of the body since the frame before, by wheels or gyroscope
  CameraMotion before{};                 // motion of the camera up to the frame before
};

// Compares each frame with those before it.
class InputWatch {
 public:
  explicit InputWatch(const ImageConditionOptions& image);

  // Rows are judged by the calibration that the frame's features were made, or made anew, by.
  InputEvidence look_at(const Frame& frame, const Rig& rig, const KnownMotion& motion = {});
  // Whether the images of the pair are out of step; call after tracking. tracked: nullptr if the frame has no pose.
  Sign out_of_step(const Frame& frame, const Rig& rig, const TrackedFrame* tracked, const MapView& map);

 private:
  void note_repetition(const Frame& frame, InputEvidence& evidence);
  void note_stillness(const Frame& frame, const Rig& rig, const KnownMotion& motion, InputEvidence& evidence);
  void note_pair(const Frame& frame, const Rig& rig, InputEvidence& evidence);

  ImageConditionOptions image_;  // constant after construction
  std::uint64_t last_content_ = 0;
  Timestamp first_shown_{};  // when the present image came first
  std::optional<double> matched_;
  std::optional<double> row_error_;  // pixels
  MatchedByPart by_part_;
  StillImage still_;
  PairTiming timing_;
};

}  // namespace byre
