#include "byre/playback/frame_source.h"

#include "byre/base/stopwatch.h"

#include <algorithm>
#include <exception>

namespace byre {

DecodeAhead::DecodeAhead(Recording& recording)
    : recording_(recording), thread_([this](const std::stop_token& stop) { decode_all(stop); }) {}

DecodeAhead::~DecodeAhead() {
  thread_.request_stop();
  free_.release();
}

void DecodeAhead::decode_all(const std::stop_token& stop) {
  for (int index = 0; index < recording_.size(); ++index) {
    free_.acquire();
    if (stop.stop_requested()) return;
    slot_of(index) = decode(index);
    filled_.release();
  }
}

DecodedFrame DecodeAhead::decode(int index) {
  const Stopwatch watch;
  DecodedFrame slot;
  slot.time = recording_.times()[static_cast<std::size_t>(index)];
  const auto warned_before = static_cast<std::ptrdiff_t>(recording_.warnings().size());
  std::string failure;
  try {
    slot.images = recording_.read(index);
  } catch (const std::exception& error) {
    failure = error.what();
  }
  const std::vector<std::string>& warnings = recording_.warnings();
  slot.warnings.assign(warnings.begin() + warned_before, warnings.end());
  if (!failure.empty()) slot.warnings.push_back("frame " + std::to_string(index) + " is skipped: " + failure);
  slot.seconds = watch.seconds();
  return slot;
}

std::optional<DecodedFrame> DecodeAhead::next() {
  if (taken_ == recording_.size()) return std::nullopt;
  filled_.acquire();
  DecodedFrame frame = std::exchange(slot_of(taken_++), {});
  free_.release();
  return frame;
}

double LiveClock::wait_until_due(Timestamp time, const std::function<bool()>& should_stop) {
  constexpr auto kStopInterval = std::chrono::milliseconds(50);
  const Clock::time_point called = Clock::now();
  if (!time_zero_) time_zero_ = called - time;
  const Clock::time_point due = *time_zero_ + time;
  for (Clock::time_point now = called; now < due && !should_stop(); now = Clock::now()) {
    std::this_thread::sleep_until(std::min<Clock::time_point>(due, now + kStopInterval));
  }
  return std::max(0.0, std::chrono::duration<double>(called - due).count());
}

const MotionSamples& FrameSource::motion() const {
  static const MotionSamples none;
  return none;
}

std::optional<FrameSource::SourceFrame> RecordingFrames::next(const std::function<bool()>& should_stop) {
  auto decoded = decoder_->next();
  if (!decoded) return std::nullopt;
  SourceFrame frame{std::move(*decoded)};
  if (is_live_) frame.late_s = clock_.wait_until_due(frame.decoded.time, should_stop);
  return frame;
}

std::optional<ImageFrame> RecordingFrames::read_again(int number) {
  decoder_.reset();  // only one thread may read
  try {
    return recording_.read(number);
  } catch (const std::exception&) {
    return std::nullopt;  // such as a disk that was removed: the map must not be lost
  }
}

}  // namespace byre
