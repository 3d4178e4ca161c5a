#pragma once

#include "byre/recording.h"

#include <array>
#include <optional>
#include <semaphore>
#include <string>
#include <thread>
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

}  // namespace byre
