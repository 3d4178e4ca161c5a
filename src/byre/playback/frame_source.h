#pragma once

#include "byre/recording.h"
#include "byre/trajectory.h"

#include <array>
#include <chrono>
#include <functional>
#include <optional>
#include <semaphore>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace byre {

// Decoded frame of a recording.
struct DecodedFrame {
  Timestamp time{};
  std::optional<ImageFrame> images;   // empty if unreadable
  std::vector<std::string> warnings;  // warnings of reading this frame
  double seconds = 0.0;               // wall time of reading
};

// Reads a recording in order on its own thread, a few frames ahead.
class DecodeAhead {
 public:
  static constexpr int kAhead = 3;  // frames

  // The recording must outlive it, and must not be read by others meanwhile.
  explicit DecodeAhead(Recording& recording);
  ~DecodeAhead();  // does not wait for remaining frames
  DecodeAhead(const DecodeAhead&) = delete;
  DecodeAhead& operator=(const DecodeAhead&) = delete;

  // Waits for the next frame; empty after the last one. If reading throws, the frame has no images, and a warning.
  std::optional<DecodedFrame> next();

 private:
  void decode_all(const std::stop_token& stop);
  DecodedFrame decode(int index);
  DecodedFrame& slot_of(int index) { return slots_[static_cast<std::size_t>(index % kAhead)]; }

  Recording& recording_;  // read by the thread only
  int taken_ = 0;         // owned by the caller of next()
  // A slot is owned by the thread while free, and by the caller once filled.
  std::array<DecodedFrame, kAhead> slots_;
  std::counting_semaphore<kAhead + 1> free_{kAhead};  // one extra to wake the thread on stop
  std::counting_semaphore<kAhead> filled_{0};
  std::jthread thread_;  // last member, as it uses the others
};

// Plays a recording in real time, starting at the first call.
class LiveClock {
 public:
  // Waits until the frame of that time is due, or should_stop() is true. Returns the delay at the call in seconds; zero
  // after waiting.
  double wait_until_due(Timestamp time, const std::function<bool()>& should_stop);

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> time_zero_;  // wall clock at time zero of the recording
};

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
