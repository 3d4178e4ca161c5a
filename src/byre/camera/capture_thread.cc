#include "byre/camera/capture_thread.h"

#include "byre/input_error.h"

#include <algorithm>
#include <exception>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

void require_size(const Camera& camera, const CaptureThread& capture, const std::string& place) {
  if (camera.width == capture.width() && camera.height == capture.height()) return;
  throw InputError(place,
                   fmt::format("is for images of {} x {} pixels, but the camera delivers {} x {}", camera.width,
                               camera.height, capture.width(), capture.height()),
                   "set the camera to that size (--size), or calibrate it at this size");
}

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

void request_calibrated_size(const Calibration& calibration, LiveCameraOptions& options) {
  if (options.request.width) return;
  options.request.width = calibration.left.width * (options.side_by_side ? 2 : 1);
  options.request.height = calibration.left.height;
}

void require_fit(const Calibration& calibration, const CaptureThread& capture, const std::string& place) {
  if (calibration.right && !capture.has_right()) {
    throw InputError(place, "is of a pair, but one camera is given",
                     "give the right camera's device too, or --side-by-side if its images contain both");
  }
  if (!calibration.right && capture.has_right()) {
    throw InputError(place, "is of one camera, but two are given", "give the calibration of the pair");
  }
  require_size(calibration.left, capture, place);
  if (calibration.right) require_size(calibration.right->camera, capture, place);
}

}  // namespace byre
