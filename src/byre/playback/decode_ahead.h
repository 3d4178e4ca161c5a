#pragma once

#include "byre/recording.h"

#include <array>
#include <optional>
#include <semaphore>
#include <string>
#include <thread>
#include <vector>

namespace byre {

// A frame of a recording, once it is in memory.
struct DecodedFrame {
  Timestamp time{};
  std::optional<ImageFrame> images;   // empty when they cannot be read
  std::vector<std::string> warnings;  // warnings that reading it gave
  double seconds = 0.0;               // wall time that reading it took
};

// Reads the frames of a recording in order, in a thread of its own that stays a few frames ahead.
class DecodeAhead {
 public:
  static constexpr int kAhead = 3;  // frames

  // The recording must outlive it, and nobody else may read from it meanwhile.
  explicit DecodeAhead(Recording& recording);
  ~DecodeAhead();  // does not wait for frames nobody asked for
  DecodeAhead(const DecodeAhead&) = delete;
  DecodeAhead& operator=(const DecodeAhead&) = delete;

  // Waits for the next frame; empty after the last one. A frame whose reading throws has no images, and a warning.
  std::optional<DecodedFrame> next();

 private:
  void decode_all(const std::stop_token& stop);
  DecodedFrame decode(int index);
  DecodedFrame& slot_of(int index) { return slots_[static_cast<std::size_t>(index % kAhead)]; }

  Recording& recording_;  // read from by the thread alone
  int taken_ = 0;         // owned by the caller of next()
  // A slot belongs to the thread from when it is free until it is filled, then to the caller until it is free again.
  std::array<DecodedFrame, kAhead> slots_;
  std::counting_semaphore<kAhead + 1> free_{kAhead};  // room for one more, to wake the thread when it is to stop
  std::counting_semaphore<kAhead> filled_{0};
  std::jthread thread_;  // the last member: it uses the others
};

}  // namespace byre
