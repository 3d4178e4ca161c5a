#pragma once

#include "byre/features/stereo_quality.h"
#include "byre/slam/frame/pair_timing.h"
#include "byre/slam/frame/still_image.h"

#include <optional>

namespace byre {

// Evidence against the images of a frame themselves.
struct InputEvidence {
  bool is_repeated = false;                   // the image equals the last one bit by bit
  bool is_still = false;                      // the image is at standstill: no evidence on freezing
  bool is_frozen = false;                     // the image is at standstill although the camera moves
  double frozen_seconds = 0.0;                // duration of the repeated or frozen image
  ImageFault right_fault = ImageFault::none;  // fault of the right image while the left one has none
  // Few corners match between the images, or on wrong rows. False if dirt hides much of the right image.
  bool cameras_disagree = false;
  Sign out_of_sync = Sign::unclear;  // one image of the pair is older than the other
};

// Motion up to a frame, by sensors and by tracking.
struct MotionEvidence {
  std::optional<BodyMotion> measured{};  // motion of the body since the frame before, by wheels or gyroscope
  CameraMotion before{};                 // motion of the camera up to the frame before
};

// Checks the images of each frame, also against earlier ones.
class ImageMonitor {
 public:
  explicit ImageMonitor(const ImageConditionOptions& image);

  // Rows are judged by the calibration that the frame's features correspond to.
  InputEvidence check(const Frame& frame, const Rig& rig, const MotionEvidence& motion = {});
  // Whether the images of the pair are out of step. Call it after tracking. tracked: nullptr without a pose.
  Sign out_of_sync(const Frame& frame, const Rig& rig, const TrackedFrame* tracked, const MapView& map);

 private:
  void note_repetition(const Frame& frame, InputEvidence& evidence);
  void note_stillness(const Frame& frame, const Rig& rig, const MotionEvidence& motion, InputEvidence& evidence);
  void note_pair(const Frame& frame, const Rig& rig, InputEvidence& evidence);

  ImageConditionOptions image_;  // constant after construction
  std::uint64_t last_content_ = 0;
  Timestamp first_shown_{};  // time of the first frame with the present image
  std::optional<double> matched_;
  std::optional<double> row_error_;  // pixels
  MatchRateGrid by_part_;
  StillImage still_;
  PairTiming timing_;
};

}  // namespace byre
