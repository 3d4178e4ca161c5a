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

// Medians of the images of one camera that were looked at, and how many of them are of no use.
struct CameraCheck {
  int images = 0;
  double brightness = 0.0;        // mean grey value, see ImageCondition
  double contrast = 0.0;          // see ImageCondition
  double sharpness = 0.0;         // see ImageCondition
  std::array<int, 5> by_fault{};  // images by ImageFault

  int of_no_use() const { return images - by_fault[0]; }
};

// How left and right images fit together, medians over the pairs that were looked at.
struct PairCheck {
  int pairs = 0;
  double matched = 0.0;            // share of the left image's features found in the right one
  double matched_at_best = 0.0;    // the same in the tenth of the image where it is largest
  double row_error = 0.0;          // pixels by which they lie off their row
  double calibration_error = 0.0;  // pixels off their row that features of a part of the image have in common, rms
};

// What can be said of a recording before anything is mapped.
struct RecordingCheck {
  int frames = 0;
  double rate_hz = 0.0;
  int gaps = 0;  // intervals of more than half as much again as usual
  double longest_gap_s = 0.0;
  int looked_at = 0;      // frames that were looked at
  int unreadable = 0;     // frames looked at that could not be read
  int without_right = 0;  // frames looked at without a right image where there should be one
  int repeated = 0;       // frames looked at that are the same as the frame before, bit by bit
  double features = 0.0;  // median count in a left image
  CameraCheck left;
  std::optional<CameraCheck> right;  // empty unless it is a stereo pair
  std::optional<PairCheck> pair;
  double field_of_view_deg = 0.0;  // left image's, horizontal
  double baseline_m = 0.0;         // 0 for one camera
  TimeCorrections times{};         // corrections of frame times
};

// Looks at so many pairs of frames that follow each other, spread over the recording. Throws InputError for a
// calibration that cannot be rectified. should_stop is asked before each.
RecordingCheck check_recording(Recording& recording, int samples, const std::function<bool()>& should_stop = {});

// Something to be done about a recording.
struct Finding {
  bool is_grave = false;  // nothing good comes of it before it is mended
  std::string what;
  std::string remedy;
};

std::vector<Finding> findings_of(const RecordingCheck& check);

// Faults of wheels, gyroscope and accelerometer of the recording, by their samples alone. source_of: file or topic of a
// sensor.
std::vector<Finding> motion_findings(const Recording& recording,
                                     const std::function<std::string(MotionSensor)>& source_of);

}  // namespace byre
