#pragma once

#include "byre/playback/decode_ahead.h"
#include "byre/playback/live_clock.h"

#include <functional>
#include <optional>
#include <utility>

namespace byre {

// Source of the frames of a run, in order.
class FrameSource {
 public:
  struct SourceFrame {
    DecodedFrame decoded;
    double late_s = 0.0;  // delay when playing in real time, seconds
  };

  virtual ~FrameSource() = default;
  virtual const Calibration& calibration() const = 0;
  // Samples of wheels and gyroscope; empty for live cameras.
  virtual const MotionSamples& motion() const;
  // Waits for the next frame; empty after the last one, or if none arrives before should_stop() is true.
  virtual std::optional<SourceFrame> next(const std::function<bool()>& should_stop) = 0;
  // Reads a frame again, by its number in order of next(), after the last call of next(). Empty for live cameras, and
  // for unreadable images.
  virtual std::optional<ImageFrame> read_again(int) { return std::nullopt; }
};

// Frames of a recording, on demand or in real time.
class RecordingFrames final : public FrameSource {
 public:
  // The recording must outlive it, and must not be read by others meanwhile.
  RecordingFrames(Recording& recording, bool is_live)
      : recording_(recording), decoder_(std::in_place, recording), is_live_(is_live) {}

  const Calibration& calibration() const override { return recording_.calibration(); }
  const MotionSamples& motion() const override { return recording_.motion(); }
  std::optional<SourceFrame> next(const std::function<bool()>& should_stop) override;
  std::optional<ImageFrame> read_again(int number) override;

 private:
  Recording& recording_;
  std::optional<DecodeAhead> decoder_;  // until the first read_again()
  LiveClock clock_;
  const bool is_live_;
};

}  // namespace byre
