#pragma once

#include "byre/image_condition.h"
#include "byre/motion_warning.h"
#include "byre/recording.h"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Medians over the sampled images of one camera, and counts of faults.
struct CameraCheck {
  int images = 0;
  double brightness = 0.0;        // mean grey value, see ImageCondition
  double contrast = 0.0;          // see ImageCondition
  double sharpness = 0.0;         // see ImageCondition
  std::array<int, 5> by_fault{};  // images by ImageFault

  int unusable() const { return images - by_fault[0]; }
};

// Consistency of left and right images, medians over the sampled pairs.
struct PairCheck {
  int pairs = 0;
  double matched = 0.0;          // share of the left image's features matched in the right one
  double best_match_rate = 0.0;  // same in the tenth of the image with the largest share
  double row_error = 0.0;        // median distance of matches from their row, pixels
  // Row error common to features of a region, pixels, root mean square over regions.
  double calibration_error = 0.0;
};

// Properties of a recording before mapping.
struct RecordingCheck {
  int frames = 0;
  double rate_hz = 0.0;
  int gaps = 0;  // intervals of more than 1.5 usual intervals
  double longest_gap_s = 0.0;
  int sampled = 0;        // sampled frames
  int unreadable = 0;     // sampled frames that could not be read
  int without_right = 0;  // sampled frames that lack their right image
  int repeated = 0;       // sampled frames that are bit-identical to the previous frame
  double features = 0.0;  // median count in a left image
  CameraCheck left;
  std::optional<CameraCheck> right;  // empty without a stereo pair
  std::optional<PairCheck> pair;
  double field_of_view_deg = 0.0;  // horizontal, of the left image
  double baseline_m = 0.0;         // 0 for one camera
  TimeCorrections times{};         // corrections of frame times
};

// Samples pairs of consecutive frames, spread over the recording. samples: number of pairs. Throws InputError for a
// calibration that cannot be rectified. should_stop: polled before each pair.
RecordingCheck check_recording(Recording& recording, int samples, const std::function<bool()>& should_stop = {});

// A problem of a recording, with a remedy.
struct Finding {
  bool is_critical = false;  // the recording is unusable until it is fixed
  std::string what;
  std::string remedy;
};

std::vector<Finding> findings_of(const RecordingCheck& check);

// Faults of wheels, gyroscope and accelerometer of the recording, from their samples alone. source_of: file or topic of
// a sensor.
std::vector<Finding> motion_findings(const Recording& recording,
                                     const std::function<std::string(MotionSensor)>& source_of);

}  // namespace byre
