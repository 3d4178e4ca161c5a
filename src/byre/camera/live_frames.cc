#include "byre/camera/live_frames.h"

#include <utility>

namespace byre {
namespace {

LiveCameraOptions of_calibrated_size(LiveCameraOptions options, const Calibration& calibration) {
  request_calibrated_size(calibration, options);
  return options;
}

}  // namespace

LiveFrames::LiveFrames(LiveCameraOptions options, const Calibration& calibration, const std::string& calibration_file,
                       std::optional<double> duration_s, std::function<void(const std::string& note)> on_note)
    : calibration_(calibration),
      duration_s_(duration_s),
      on_note_(std::move(on_note)),
      capture_(of_calibrated_size(std::move(options), calibration), FrameRetention::newest) {
  require_fit(calibration, capture_, calibration_file);
}

bool LiveFrames::is_over() const {
  if (!duration_s_ || !first_) return false;
  return since_first_->seconds() > *duration_s_ || to_seconds(*last_ - *first_) > *duration_s_;
}

void LiveFrames::report_notes() {
  for (const std::string& note : capture_.take_notes()) on_note_(note);
}

std::optional<FrameSource::SourceFrame> LiveFrames::next(const std::function<bool()>& should_stop) {
  constexpr auto kStopInterval = std::chrono::milliseconds(50);
  while (!should_stop() && !is_over()) {
    auto images = capture_.next(kStopInterval);
    report_notes();
    if (!images) continue;
    if (!first_) first_ = images->time;
    if (!since_first_) since_first_.emplace();
    last_ = images->time;
    if (is_over()) break;
    SourceFrame frame;
    frame.decoded.time = images->time;
    frame.decoded.images = std::move(images);
    return frame;
  }
  capture_.stop();
  return std::nullopt;
}

LiveCameraReport LiveFrames::finish() {
  capture_.stop();
  report_notes();
  return capture_.report();
}

}  // namespace byre
