#include "byre/camera/capture_thread.h"

#include <exception>
#include <utility>

namespace byre {
namespace {

constexpr std::size_t kMostNotes = 100;

}  // namespace

CaptureThread::CaptureThread(const LiveCameraOptions& options, std::size_t kept)
    : cameras_(options),
      has_right_(cameras_.has_right()),
      width_(cameras_.width()),
      height_(cameras_.height()),
      frames_(kept),
      notes_(kMostNotes),
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

std::optional<ImageFrame> CaptureThread::next(std::chrono::milliseconds at_most) {
  return frames_.take(at_most);
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
