#include "byre/camera/capture_thread.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace byre {
namespace {

constexpr std::size_t kMaxNotes = 100;

std::size_t capacity_for(FrameRetention retention, const LiveCameras& cameras) {
  if (retention == FrameRetention::newest) return 1;
  constexpr std::size_t kMaxBytes = 256u << 20;
  constexpr std::size_t kFewest = 8;
  const std::size_t bytes = static_cast<std::size_t>(cameras.width()) * static_cast<std::size_t>(cameras.height()) *
                            (cameras.has_right() ? 2 : 1);
  return std::max(kFewest, kMaxBytes / bytes);
}

}  // namespace

CaptureThread::CaptureThread(const LiveCameraOptions& options, FrameRetention retention)
    : cameras_(options),
      has_right_(cameras_.has_right()),
      width_(cameras_.width()),
      height_(cameras_.height()),
      rate_hz_(cameras_.report().devices.front().mode.rate_hz),
      frames_(capacity_for(retention, cameras_)),
      notes_(kMaxNotes),
      thread_([this](const std::stop_token& stop) { capture(stop); }) {}

CaptureThread::~CaptureThread() = default;

void CaptureThread::capture(const std::stop_token& stop) {
  constexpr int kStopInterval = 100;  // milliseconds
  try {
    while (!stop.stop_requested()) {
      for (ImageFrame& frame : cameras_.wait(kStopInterval)) frames_.put(std::move(frame));
      for (std::string& note : cameras_.take_notes()) notes_.put(std::move(note));
    }
  } catch (...) {
    frames_.fail(std::current_exception());
  }
}

std::optional<ImageFrame> CaptureThread::next(std::chrono::milliseconds timeout) {
  return frames_.take(timeout);
}

std::vector<std::string> CaptureThread::take_notes() {
  std::vector<std::string> notes;
  while (auto note = notes_.take({})) notes.push_back(std::move(*note));
  return notes;
}

void CaptureThread::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

}  // namespace byre
