#include "byre/io/recording/recording_check.h"

#include "byre/features/extract.h"
#include "byre/features/stereo_quality.h"
#include "byre/geometry/median.h"
#include "byre/odometry/recorded_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

double median_or_zero(const std::vector<double>& values) {
  return values.empty() ? 0.0 : median(values);
}

class CameraSum {
 public:
  void add(const ImageCondition& condition) {
    brightness_.push_back(condition.brightness);
    contrast_.push_back(condition.contrast);
    sharpness_.push_back(condition.sharpness);
    ++check_.images;
    ++check_.by_fault[static_cast<std::size_t>(fault_of(condition, {}))];
  }

  CameraCheck result() const {
    CameraCheck check = check_;
    check.brightness = median_or_zero(brightness_);
    check.contrast = median_or_zero(contrast_);
    check.sharpness = median_or_zero(sharpness_);
    return check;
  }

 private:
  CameraCheck check_;
  std::vector<double> brightness_, contrast_, sharpness_;
};

class PairSum {
 public:
  explicit PairSum(const Rig& rig) : rig_(rig) {}

  void add(const Features& features) {
    std::vector<double> errors;
    for (const Keypoint& keypoint : features.keypoints()) {
      if (!keypoint.has_disparity()) continue;
      errors.push_back(std::abs(keypoint.row_offset));
    }
    ++pairs_;
    by_part_.note(features, rig_);
    common_error_.note(features, rig_);
    if (features.size() > 0) matched_.push_back(static_cast<double>(errors.size()) / features.size());
    if (!errors.empty()) row_errors_.push_back(median(std::move(errors)));
  }

  PairCheck result() const {
    return {pairs_, median_or_zero(matched_), by_part_.best_rate(), median_or_zero(row_errors_),
            common_error_.pixels().value_or(0.0)};
  }

 private:
  Rig rig_;
  int pairs_ = 0;
  std::vector<double> matched_, row_errors_;
  MatchRateGrid by_part_{1.0};
  CommonRowError common_error_;
};

void check_times(const std::vector<Timestamp>& times, RecordingCheck& check) {
  constexpr double kGap = 1.5;  // usual intervals
  check.frames = static_cast<int>(times.size());
  std::vector<double> intervals;
  for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(to_seconds(times[i] - times[i - 1]));
  if (intervals.empty()) return;
  const double usual = median(intervals);
  check.rate_hz = usual > 0.0 ? 1.0 / usual : 0.0;
  check.gaps = static_cast<int>(std::ranges::count_if(intervals, [&](double s) { return s > kGap * usual; }));
  check.longest_gap_s = std::ranges::max(intervals);
}

// Indices of the first frames of the sampled pairs, spread evenly over the recording.
std::vector<int> sample_frames(int frames, int samples) {
  std::vector<int> first;
  const int count = std::max(1, std::min(samples, frames / 2));
  for (int i = 0; i < count; ++i) first.push_back(static_cast<int>(static_cast<long long>(i) * frames / count));
  return first;
}

// Accumulates properties of frames.
class FrameSum {
 public:
  explicit FrameSum(const Calibration& calibration)
      : is_pair_(calibration.right.has_value()), extractor_(calibration, {}), pair_(extractor_.rig()) {}

  const Rig& rig() const { return extractor_.rig(); }

  void add(const std::optional<ImageFrame>& images, std::uint64_t content_before, RecordingCheck& check) {
    ++check.sampled;
    content_ = 0;
    if (!images) {
      ++check.unreadable;
      return;
    }
    const Frame frame = extractor_.extract(*images).frame;
    content_ = frame.content;
    if (content_before != 0 && content_before == content_) ++check.repeated;
    left_.add(*frame.condition);
    features_.push_back(frame.features->size());
    if (frame.right_condition) {
      right_.add(*frame.right_condition);
      pair_.add(*frame.features);
    } else if (is_pair_) {
      ++check.without_right;
    }
  }

  std::uint64_t content() const { return content_; }  // checksum of the last frame; 0 if it was unreadable

  void write_to(RecordingCheck& check) const {
    check.left = left_.result();
    check.features = median_or_zero(features_);
    if (right_.result().images == 0) return;
    check.right = right_.result();
    check.pair = pair_.result();
  }

 private:
  bool is_pair_;
  Extractor extractor_;
  CameraSum left_, right_;
  PairSum pair_;
  std::vector<double> features_;
  std::uint64_t content_ = 0;
};

void add_times(const RecordingCheck& check, std::vector<Finding>& findings) {
  if (check.rate_hz > 0.0 && check.rate_hz < 5.0) {
    findings.push_back({false, fmt::format("frame rate of only {:.1f} Hz", check.rate_hz),
                        "drive slowly: features that leave the view between two frames cannot be tracked"});
  }
  if (check.gaps > check.frames / 50) {
    findings.push_back({false,
                        fmt::format("{} gaps between frames, the longest {:.2f} s", check.gaps, check.longest_gap_s),
                        "check disk, cable and encoder for insufficient speed while recording"});
  }
  if (check.unreadable > 0) {
    findings.push_back({check.unreadable > check.sampled / 10,
                        fmt::format("{} of the checked images cannot be read", check.unreadable),
                        "record again, or exclude them with --frames"});
  }
  if (check.repeated > check.sampled / 20) {
    findings.push_back(
        {true, fmt::format("{} images are identical to the previous one, bit by bit", check.repeated),
         "the camera or its driver stalls; restart it and check for a fault, as motion is not measured meanwhile"});
  }
}

void add_clock(const TimeCorrections& times, std::vector<Finding>& findings) {
  if (!times.clock_steps.empty()) {
    const ClockStep& first = times.clock_steps.front();
    const std::string count =
        fmt::format("the image clock was set {} time{} while recording", static_cast<int>(times.clock_steps.size()),
                    times.clock_steps.size() > 1 ? "s" : "");
    findings.push_back({false,
                        count + fmt::format(", first by {:.3f} s at frame {}; times after it are shifted",
                                            to_seconds(first.by), first.frame),
                        "set clocks before recording and slew them afterwards instead of stepping (chrony without "
                        "makestep); do not record a bag that is played in a loop"});
  }
  if (times.source != TimeSource::stamps) {
    const char* const used = times.source == TimeSource::receive_times ? "receive times are used"
                                                                       : "images of each time stamp are spread evenly";
    findings.push_back(
        {false, std::string("images have no time stamps, or time stamps in whole seconds; ") + used,
         "stamp each image in the driver with microsecond resolution: velocities, wheels and gyroscopes require it"});
  }
  if (times.unstamped > 0) {
    findings.push_back(
        {false, fmt::format("{} images have a zero or wrong time stamp; their times are interpolated", times.unstamped),
         "start recording after the driver begins to stamp images"});
  }
  if (times.late > 0) {
    findings.push_back({false, fmt::format("{} images were recorded after later ones; they are sorted", times.late),
                        "check for a node that republishes images, and record the driver's own topic"});
  }
  if (times.repeated > 0) {
    findings.push_back({false,
                        fmt::format("{} images have the time stamp of another image; they are ignored", times.repeated),
                        "check for two publishers of one topic, and for a driver that repeats images"});
  }
}

void add_camera(const CameraCheck& camera, const char* name, std::vector<Finding>& findings) {
  constexpr std::array<std::string_view, 5> kRemedies = {
      "", "increase light, exposure time or gain", "reduce the exposure time",
      "remove the cap or cover, clean the lens", "focus the lens, reduce the exposure time"};
  for (std::size_t i = 1; i < camera.by_fault.size(); ++i) {
    if (camera.by_fault[i] <= camera.images / 20) continue;
    findings.push_back({camera.by_fault[i] > camera.images / 2,
                        fmt::format("{} of {} {}images are {}", camera.by_fault[i], camera.images, name,
                                    to_string(static_cast<ImageFault>(i))),
                        std::string(kRemedies[i])});
  }
}

void add_pair(const RecordingCheck& check, std::vector<Finding>& findings) {
  if (check.without_right > check.sampled / 20) {
    findings.push_back({false, fmt::format("{} frames have no right image", check.without_right),
                        "check why the recorder drops them, or use one camera with --camera left"});
  }
  if (!check.pair || (check.right && check.right->unusable() > check.right->images / 2)) return;
  if (is_partly_hidden({check.pair->matched, check.pair->best_match_rate, check.pair->row_error})) {
    findings.push_back(
        {false,
         fmt::format("only {:.1f} % of the features match in the right image, but {:.0f} % in parts of it",
                     100.0 * check.pair->matched, 100.0 * check.pair->best_match_rate),
         "parts of the images are hidden: clean the lenses"});
  } else if (check.pair->matched < kMinMatchedShare) {
    findings.push_back(
        {true, fmt::format("only {:.1f} % of the features match in the right image", 100.0 * check.pair->matched),
         "check whether left and right are swapped, upside down or unsynchronised, and whether the calibration is of "
         "this pair"});
  } else if (check.pair->row_error > kMaxRowOffset) {
    findings.push_back({true,
                        fmt::format("features of the right image are {:.2f} px off their row", check.pair->row_error),
                        "the cameras are unsynchronised, or one has moved since calibration: check the trigger, "
                        "then run \"byre calibrate\""});
  } else if (check.pair->calibration_error > kMaxCommonRowError) {
    findings.push_back({false, fmt::format("the calibration error is about {:.2f} px", check.pair->calibration_error),
                        "run \"byre calibrate\" on a minute of motion"});
  }
}

void add_rig(const RecordingCheck& check, std::vector<Finding>& findings) {
  if (check.field_of_view_deg < 30.0 || check.field_of_view_deg > 170.0) {
    findings.push_back({false, fmt::format("a field of view of {:.0f} degrees", check.field_of_view_deg),
                        "check that the calibration is of this camera at this resolution"});
  }
  if (check.features < 200.0 && check.left.unusable() <= check.left.images / 2) {
    findings.push_back({false, fmt::format("only {:.0f} features per image", check.features),
                        "record scenes with texture; clean the lens; check light and focus"});
  }
}

}  // namespace

RecordingCheck check_recording(Recording& recording, int samples, const std::function<bool()>& should_stop) {
  RecordingCheck check;
  check_times(recording.times(), check);
  check.times = recording.time_corrections();
  FrameSum sum(recording.calibration());
  const Camera& camera = recording.calibration().left;
  check.field_of_view_deg = 2.0 * std::atan(0.5 * camera.width / camera.fx) * 180.0 / std::numbers::pi;
  check.baseline_m = recording.calibration().right ? sum.rig().baseline : 0.0;
  for (const int first : sample_frames(recording.size(), samples)) {
    if (should_stop && should_stop()) break;
    sum.add(recording.read(first), 0, check);
    const std::uint64_t before = sum.content();
    if (first + 1 < recording.size()) sum.add(recording.read(first + 1), before, check);
  }
  sum.write_to(check);
  return check;
}

std::vector<Finding> motion_findings(const Recording& recording,
                                     const std::function<std::string(MotionSensor)>& source_of) {
  std::vector<Finding> findings;
  const std::vector<Timestamp>& times = recording.times();
  if (times.empty()) return findings;
  for (const MotionWarning& warning : check_motion(recording.motion(), times.front(), times.back())) {
    const std::string what = to_text({warning.sensor, warning.time, warning.what, ""}, source_of(warning.sensor));
    findings.push_back({false, what, warning.remedy});
  }
  return findings;
}

std::vector<Finding> findings_of(const RecordingCheck& check) {
  std::vector<Finding> findings;
  add_times(check, findings);
  add_clock(check.times, findings);
  add_camera(check.left, check.right ? "left " : "", findings);
  if (check.right) add_camera(*check.right, "right ", findings);
  add_pair(check, findings);
  add_rig(check, findings);
  std::ranges::stable_sort(findings, std::ranges::greater{}, &Finding::is_critical);
  return findings;
}

}  // namespace byre
