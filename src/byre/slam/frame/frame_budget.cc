#include "byre/slam/frame/frame_budget.h"

#include <chrono>
#include <cmath>
#include <utility>

namespace byre {
namespace {

// Share of the time of a stage with skipped work, before the first measurement.
constexpr double kShareOfCut = 0.6;

}  // namespace

void ExpectedTime::note(double seconds) {
  constexpr double kGain = 0.125;
  constexpr double kDeviationGain = 0.25;
  if (!mean_) {
    mean_ = seconds;
    return;
  }
  deviation_ += kDeviationGain * (std::abs(seconds - *mean_) - deviation_);
  *mean_ += kGain * (seconds - *mean_);
}

// Halves the expectation within 280 frames, 14 s at 20 Hz.
void ExpectedTime::decay() {
  constexpr double kKept = 0.9975;
  if (mean_) *mean_ *= kKept;
  deviation_ *= kKept;
}

std::optional<double> ExpectedTime::seconds() const {
  constexpr double kDeviations = 1.5;
  return mean_ ? std::optional(*mean_ + kDeviations * deviation_) : std::nullopt;
}

void FrameBudget::Stage::note(double seconds, bool is_cut) {
  (is_cut ? cut : whole).note(seconds);
  if (is_cut) whole.decay();
}

double FrameBudget::Stage::expected_when_cut() const {
  return cut.seconds().value_or(kShareOfCut * expected());
}

FrameBudget::FrameBudget(double deadline, Clock clock) : deadline_(deadline), clock_(std::move(clock)) {}

FrameBudget::Clock FrameBudget::wall_clock() {
  return [] { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); };
}

void FrameBudget::begin() {
  begun_ = clock_();
  tracking_begun_ = 0.0;
  tracking_ended_.reset();
  cuts_ = {};
  is_whole_ = std::exchange(is_next_whole_, false);
}

bool FrameBudget::has_time_for_right_image() {
  const double expected = images_.expected() + tracking_.expected_when_cut() + rest_.mean();
  cuts_.right_image = is_set() && !is_whole_ && expected > deadline_;
  return !cuts_.right_image;
}

FrameCuts FrameBudget::begin_tracking() {
  tracking_begun_ = elapsed();
  const double expected = tracking_begun_ + tracking_.expected() + rest_.mean();
  cuts_.online_points = is_set() && !is_whole_ && expected > deadline_;
  return cuts_;
}

void FrameBudget::note_tracked() {
  tracking_ended_ = elapsed();
}

void FrameBudget::end() {
  const double seconds = elapsed();
  is_late_ = is_set() && seconds > deadline_;
  images_.note(tracking_begun_, cuts_.right_image);
  if (!tracking_ended_) return;
  tracking_.note(*tracking_ended_ - tracking_begun_, cuts_.online_points);
  rest_.note(seconds - *tracking_ended_);
}

}  // namespace byre
