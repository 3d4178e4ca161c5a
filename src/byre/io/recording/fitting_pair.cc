#include "byre/io/recording/fitting_pair.h"

#include "byre/features/extract.h"
#include "byre/features/stereo_quality.h"
#include "byre/geometry/median.h"
#include "byre/geometry/rectification.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

namespace byre {
namespace {

// Possible arrangement of a recorded pair, with the right camera to the right.
struct PairReading {
  Calibration calibration;
  bool exchanges_images = false;
  std::string_view fault = {};  // empty for the pair as recorded
  std::string_view action = {};
  std::string_view remedy = {};
};

Calibration with_exchanged_cameras(const Calibration& pair) {
  Calibration exchanged = pair;
  exchanged.left = pair.right->camera;
  exchanged.right = StereoPartner{pair.left, inverse(pair.right->right_from_left)};
  exchanged.body_from_left = pair.body_from_left * inverse(pair.right->right_from_left);
  return exchanged;
}

// The baseline reversed: the extrinsics are inverse, or their translation has the wrong sign.
std::vector<Calibration> with_reversed_baseline(const Calibration& pair) {
  std::vector<Calibration> reversed(2, pair);
  reversed[0].right->right_from_left = inverse(pair.right->right_from_left);
  reversed[1].right->right_from_left.translation *= -1.0;
  return reversed;
}

// Readings of a pair; the first one is the pair as recorded. Empty if it cannot be rectified.
std::vector<PairReading> readings_of(const Calibration& pair) {
  const Calibration exchanged = with_exchanged_cameras(pair);
  std::vector<PairReading> all;
  if (can_be_rectified(pair)) {
    all.push_back({pair});
    all.push_back({pair, true, "left and right images are exchanged", "the images are exchanged back",
                   "exchange the folders or the topics of the images"});
    for (const Calibration& reversed : with_reversed_baseline(pair)) {
      all.push_back({with_exchanged_cameras(reversed), true,
                     "left and right are exchanged, and the baseline has the wrong sign",
                     "cameras and images are exchanged, and the baseline is reversed",
                     "exchange images and cameras, and correct the extrinsics of the pair"});
    }
  } else if (can_be_rectified(exchanged)) {
    all.push_back({exchanged, true, "the right camera is to the left of the left one",
                   "cameras and images are exchanged", "exchange left and right in recording and calibration"});
    for (const Calibration& reversed : with_reversed_baseline(pair)) {
      all.push_back({reversed, false, "the calibration has the right camera to the left, against the images",
                     "the baseline is reversed",
                     "correct the extrinsics of the pair: they are inverse, or their translation has the wrong sign"});
    }
    all.push_back({exchanged, false, "the calibration has left and right exchanged, against the images",
                   "the cameras of the calibration are exchanged", "exchange the cameras in the calibration"});
  }
  std::vector<PairReading> possible;
  for (const PairReading& reading : all) {
    const auto size_of = [](const Camera& camera) { return std::pair(camera.width, camera.height); };
    const Camera& left_images = reading.exchanges_images ? pair.right->camera : pair.left;
    const bool is_new = std::ranges::none_of(possible, [&](const PairReading& other) {
      return other.exchanges_images == reading.exchanges_images && other.calibration == reading.calibration;
    });
    if (is_new && size_of(reading.calibration.left) == size_of(left_images) && can_be_rectified(reading.calibration)) {
      possible.push_back(reading);
    }
  }
  return possible;
}

void exchange_images(ImageFrame& images) {
  std::swap(images.left, *images.right);
}

// Fit of one frame to a reading.
struct FrameFit {
  int features = 0;
  double matched = 0.0;  // share of the features
  double near = 0.0;     // share of the features matched with a large parallax
  double row_error = 0.0;
};

// Evidence of the sampled frames for a reading.
class ReadingEvidence {
 public:
  explicit ReadingEvidence(PairReading reading) : reading_(std::move(reading)), extractor_(reading_.calibration, {}) {}

  const PairReading& reading() const { return reading_; }
  int frames() const { return frames_; }
  double matched() const { return matched_ / std::max(1, frames_); }  // mean share in these frames

  FrameFit fit(ImageFrame images) {
    // Tangent of parallax. A smaller one is also caused by a camera turned by a degree.
    constexpr double kLargeParallax = 0.015;
    if (reading_.exchanges_images) exchange_images(images);
    const Frame frame = extractor_.extract(images).frame;
    FrameFit fit{.features = frame.features->size()};
    std::vector<double> row_errors;
    int near = 0;
    for (const Keypoint& keypoint : frame.features->keypoints()) {
      if (!keypoint.has_disparity()) continue;
      row_errors.push_back(std::abs(keypoint.row_offset));
      if (keypoint.disparity > kLargeParallax * extractor_.rig().focal) ++near;
    }
    if (row_errors.empty()) return fit;
    fit.matched = static_cast<double>(row_errors.size()) / fit.features;
    fit.near = static_cast<double>(near) / fit.features;
    fit.row_error = median(std::move(row_errors));
    return fit;
  }

  void count(const FrameFit& fit) {
    ++frames_;
    matched_ += fit.matched;
  }

 private:
  PairReading reading_;
  Extractor extractor_;
  int frames_ = 0;
  double matched_ = 0.0;
};

// Whether a frame fits a reading well. Stricter than for a pair as recorded: a camera turned by degrees since
// calibration may fit a wrong reading, but with fewer matches off their rows.
bool is_evidence(const FrameFit& fit) {
  constexpr int kLeastMatches = 40;
  constexpr double kLeastShare = 0.2;
  constexpr double kLargestRowError = 0.5;  // pixels
  return fit.near >= kLeastShare && fit.near * fit.features >= kLeastMatches && fit.row_error <= kLargestRowError;
}

// Frames spread over the first seconds, or the first frames of a slow recording.
std::vector<int> first_frames(const std::vector<Timestamp>& times) {
  constexpr int kFrames = 10;
  constexpr double kSeconds = 5.0;
  const auto end = std::ranges::upper_bound(times, times.front() + from_seconds(kSeconds));
  const int count = std::min(kFrames, static_cast<int>(times.size()));
  const int within = std::max(count, static_cast<int>(end - times.begin()));
  std::vector<int> frames;
  for (int i = 0; i < count; ++i) frames.push_back(i * within / count);
  return frames;
}

struct Verdict {
  PairReading reading;
  double matched = 0.0;                      // mean share of features that match
  std::optional<double> matched_recorded{};  // mean share as recorded; empty if that cannot be rectified
};

// The reading that the images show. Empty for the pair as recorded, and without sufficient evidence.
std::optional<Verdict> choose_reading(Recording& recording) {
  constexpr int kLeastFeatures = 100;  // frames with fewer are no evidence
  constexpr int kLeastFrames = 3;
  constexpr double kLeastRatio = 8.0;  // matches of the other reading to those of the pair as recorded
  const std::vector<PairReading> readings = readings_of(recording.calibration());
  if (readings.empty()) return std::nullopt;
  std::vector<ReadingEvidence> evidence;
  evidence.emplace_back(readings.front());
  const bool is_usable = readings.front().fault.empty();
  int textured = 0;
  double sum_recorded = 0.0;
  for (const int index : first_frames(recording.times())) {
    const std::optional<ImageFrame> images = recording.read(index);
    if (!images || !images->right) continue;
    const FrameFit recorded = evidence.front().fit(*images);
    if (is_usable && recorded.matched >= kMinMatchedShare) return std::nullopt;
    if (recorded.features < kLeastFeatures) continue;
    ++textured;
    sum_recorded += recorded.matched;
    if (is_evidence(recorded)) evidence.front().count(recorded);
    for (std::size_t i = 1; i < readings.size(); ++i) {
      if (i == evidence.size()) evidence.emplace_back(readings[i]);
      const FrameFit other = evidence[i].fit(*images);
      if (is_evidence(other) && other.matched >= kLeastRatio * recorded.matched) evidence[i].count(other);
    }
  }
  const auto best = std::ranges::max_element(
      evidence, {}, [](const ReadingEvidence& each) { return std::pair(each.frames(), each.matched()); });
  if (best->reading().fault.empty() || best->frames() < kLeastFrames || 5 * best->frames() < 4 * textured) {
    return std::nullopt;
  }
  return Verdict{best->reading(), best->matched(), is_usable ? std::optional(sum_recorded / textured) : std::nullopt};
}

std::string warning_of(const Verdict& verdict, const std::string& place) {
  const auto& [reading, matched, matched_recorded] = verdict;
  const std::string recorded = matched_recorded ? fmt::format(" instead of {:.1f} %", 100.0 * *matched_recorded) : "";
  return fmt::format("{}: {}; {}, so that {:.0f} %{} of the features match. To make this permanent, {}", place,
                     reading.fault, reading.action, 100.0 * matched, recorded, reading.remedy);
}

// The recording by a reading. Its warnings do not include those of frames read to choose the reading.
class ReadPair final : public Recording {
 public:
  ReadPair(std::unique_ptr<Recording> recording, Calibration calibration, bool exchanges_images,
           std::vector<std::string> warnings)
      : recording_(std::move(recording)),
        calibration_(std::move(calibration)),
        motion_(recording_->motion()),
        exchanges_images_(exchanges_images),
        warnings_(std::move(warnings)) {
    if (!motion_.left_from_gyroscope) return;
    const Eigen::Quaterniond body_from_recorded = recording_->calibration().body_from_left.rotation;
    motion_.left_from_gyroscope =
        calibration_.body_from_left.rotation.conjugate() * body_from_recorded * *motion_.left_from_gyroscope;
  }

  const Calibration& calibration() const override { return calibration_; }
  const std::vector<Timestamp>& times() const override { return recording_->times(); }
  const MotionSamples& motion() const override { return motion_; }
  const TimeCorrections& time_corrections() const override { return recording_->time_corrections(); }
  const std::vector<std::string>& warnings() const override { return warnings_; }

  std::optional<ImageFrame> read(int index) override {
    const auto before = static_cast<std::ptrdiff_t>(recording_->warnings().size());
    std::optional<ImageFrame> images = recording_->read(index);
    const std::vector<std::string>& all = recording_->warnings();
    std::copy(all.begin() + before, all.end(), std::back_inserter(warnings_));
    if (!exchanges_images_ || !images) return images;
    if (!images->right) return std::nullopt;
    exchange_images(*images);
    return images;
  }

 private:
  std::unique_ptr<Recording> recording_;
  Calibration calibration_;            // constant after construction
  MotionSamples motion_;               // constant after construction
  bool exchanges_images_;              // constant after construction
  std::vector<std::string> warnings_;  // grows with read
};

}  // namespace

std::unique_ptr<Recording> with_fitting_pair(std::unique_ptr<Recording> recording, const std::string& place) {
  if (!recording->calibration().right) return recording;
  std::vector<std::string> warnings = recording->warnings();
  const std::optional<Verdict> verdict = choose_reading(*recording);
  if (verdict) {
    warnings.push_back(warning_of(*verdict, place));
    const auto& [calibration, exchanges_images, fault, action, remedy] = verdict->reading;
    return std::make_unique<ReadPair>(std::move(recording), calibration, exchanges_images, std::move(warnings));
  }
  if (warnings.size() == recording->warnings().size()) return recording;
  Calibration same = recording->calibration();
  return std::make_unique<ReadPair>(std::move(recording), std::move(same), false, std::move(warnings));
}

}  // namespace byre
