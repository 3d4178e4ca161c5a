#pragma once

#include "byre/camera/live_cameras.h"
#include "byre/workers/newest_queue.h"

#include <cstdint>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace byre {

// What becomes of frames that nobody has taken yet.
//   newest  the newest alone is kept: for who must not fall behind
//   all     all are, as far as memory goes: for who must not miss any
enum class KeptFrames : std::uint8_t { newest, all };

// Takes what cameras give, in a thread of its own, so that no image waits in a driver. Whoever is slow misses the
// oldest frames beyond those that are kept.
class CaptureThread {
 public:
  CaptureThread(const LiveCameraOptions& options, KeptFrames kept);  // throws InputError as LiveCameras does
  ~CaptureThread();
  CaptureThread(const CaptureThread&) = delete;
  CaptureThread& operator=(const CaptureThread&) = delete;

  // Constant after construction.
  bool has_right() const { return has_right_; }
  int width() const { return width_; }
  int height() const { return height_; }
  double rate_hz() const { return rate_hz_; }  // zero: not told

  // The next frame, waited for at most so long. Throws InputError when the cameras turned out to be of no use.
  std::optional<ImageFrame> next(std::chrono::milliseconds at_most);
  std::vector<std::string> take_notes();
  int passed_over() const { return frames_.dropped(); }

  // Ends the thread; frames that wait can still be taken.
  void stop();
  LiveCameraReport report() const { return cameras_.report(); }  // after stop()

 private:
  void capture(const std::stop_token& stop);

  LiveCameras cameras_;  // used by the thread alone until it has stopped
  const bool has_right_;
  const int width_;
  const int height_;
  const double rate_hz_;
  NewestQueue<ImageFrame> frames_;
  NewestQueue<std::string> notes_;
  std::jthread thread_;  // the last member: it uses the others
};

}  // namespace byre
