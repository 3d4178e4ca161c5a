#pragma once

#include "byre/base/newest_queue.h"
#include "byre/calibration.h"
#include "byre/camera/live_cameras.h"

#include <cstdint>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace byre {

// Frames kept until they are taken.
//   newest  only the newest: for consumers that must not fall behind
//   all     all, within a memory limit: for consumers that must not miss any
enum class FrameRetention : std::uint8_t { newest, all };

// Captures frames in its own thread, so that no image waits in a driver. A slow consumer misses the oldest frames
// beyond those kept.
class CaptureThread {
 public:
  CaptureThread(const LiveCameraOptions& options, FrameRetention retention);  // throws InputError like LiveCameras
  ~CaptureThread();
  CaptureThread(const CaptureThread&) = delete;
  CaptureThread& operator=(const CaptureThread&) = delete;

  // Constant after construction.
  bool has_right() const { return has_right_; }
  int width() const { return width_; }
  int height() const { return height_; }
  double rate_hz() const { return rate_hz_; }  // zero: unknown

  // The next frame; waits at most this long. Throws InputError if the cameras are unusable.
  std::optional<ImageFrame> next(std::chrono::milliseconds timeout);
  std::vector<std::string> take_notes();
  int skipped() const { return frames_.dropped(); }

  // Ends the thread. Waiting frames can still be taken.
  void stop();
  LiveCameraReport report() const { return cameras_.report(); }  // after stop()

 private:
  void capture(const std::stop_token& stop);

  LiveCameras cameras_;  // used only by the thread until it has stopped
  const bool has_right_;
  const int width_;
  const int height_;
  const double rate_hz_;
  NewestQueue<ImageFrame> frames_;
  NewestQueue<std::string> notes_;
  std::jthread thread_;  // last member, because it uses the others
};

// Requests images of the calibrated size, unless the options request a size.
void request_calibrated_size(const Calibration& calibration, LiveCameraOptions& options);

// Throws InputError if the calibration has another number of cameras, or another image size. place: its file.
void require_fit(const Calibration& calibration, const CaptureThread& capture, const std::string& place);

}  // namespace byre
