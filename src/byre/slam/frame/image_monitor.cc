#include "byre/slam/frame/image_monitor.h"

#include "byre/geometry/median.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace byre {
namespace {

constexpr int kMinFeaturesJudged = 100;  // corners needed to judge a pair
constexpr double kMemory = 0.7;          // share of earlier measures kept from frame to frame

double blend(std::optional<double> before, double now) {
  return before ? kMemory * *before + (1.0 - kMemory) * now : now;
}

}  // namespace

ImageMonitor::ImageMonitor(const ImageConditionOptions& image) : image_(image), by_part_(kMemory) {}

InputEvidence ImageMonitor::check(const Frame& frame, const Rig& rig, const MotionEvidence& motion) {
  InputEvidence evidence;
  note_repetition(frame, evidence);
  note_stillness(frame, rig, motion, evidence);
  if (frame.condition && frame.right_condition) note_pair(frame, rig, evidence);
  return evidence;
}

// Sensor noise makes consecutive images differ, even at standstill.
void ImageMonitor::note_repetition(const Frame& frame, InputEvidence& evidence) {
  evidence.is_repeated = frame.content != 0 && frame.content == last_content_;
  if (!evidence.is_repeated) first_shown_ = frame.time;
  evidence.frozen_seconds = to_seconds(frame.time - first_shown_);
  last_content_ = frame.content;
}

void ImageMonitor::note_stillness(const Frame& frame, const Rig& rig, const MotionEvidence& motion,
                                  InputEvidence& evidence) {
  if (!frame.condition || fault_of(*frame.condition, image_) != ImageFault::none) return still_.forget();
  const Stillness stillness = still_.note(frame, rig, motion.measured, motion.before);
  evidence.is_still = stillness.is_still;
  evidence.is_frozen = stillness.is_frozen;
  if (stillness.is_frozen) evidence.frozen_seconds = std::max(evidence.frozen_seconds, stillness.seconds);
}

Sign ImageMonitor::out_of_sync(const Frame& frame, const Rig& rig, const TrackedFrame* tracked, const MapView& map) {
  if (tracked != nullptr && frame.right_condition) return timing_.note(frame, rig, *tracked, map);
  timing_.skip();
  return Sign::unclear;
}

void ImageMonitor::note_pair(const Frame& frame, const Rig& rig, InputEvidence& evidence) {
  if (fault_of(*frame.condition, image_) != ImageFault::none) return;
  evidence.right_fault = fault_of(*frame.right_condition, image_);
  if (evidence.right_fault != ImageFault::none || frame.features->size() < kMinFeaturesJudged) return;
  ScratchVector<float> row_errors;
  row_errors.reserve(static_cast<std::size_t>(frame.features->size()));
  for (const Keypoint& keypoint : frame.features->keypoints()) {
    if (keypoint.has_disparity()) row_errors.push_back(std::abs(keypoint.row_offset));
  }
  constexpr std::size_t kEnough = 10;  // for a median
  const double matched = static_cast<double>(row_errors.size()) / frame.features->size();
  matched_ = blend(matched_, matched);
  if (row_errors.size() >= kEnough) row_error_ = blend(row_error_, median_of(std::span(row_errors)));
  by_part_.note(*frame.features, rig);
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  evidence.cameras_disagree = !is_consistent({*matched_, by_part_.best_rate(), row_error_.value_or(kUnknown)});
}

}  // namespace byre
