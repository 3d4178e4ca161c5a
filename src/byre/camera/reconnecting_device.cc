#include "byre/camera/reconnecting_device.h"

#include "byre/input_error.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

constexpr Timestamp kRetryInterval = 200ms;
constexpr int kMaxAtOnce = 8;  // images, so that other devices get their turn

// Cameras need some time from their start to the first image.
Timestamp patience_for(const VideoMode& mode) {
  constexpr Timestamp kMin = 3s;
  constexpr double kFrames = 10.0;
  return mode.rate_hz > 0.0 ? std::max(kMin, from_seconds(kFrames / mode.rate_hz)) : kMin;
}

}  // namespace

// Numbers count modulo 2^32. A step back by less than half of it is a restart of the driver.
void SequenceCounter::note_number(std::uint32_t sequence) {
  constexpr std::uint32_t kHalf = 1u << 31;
  const std::uint32_t gap = sequence - next_.value_or(sequence);
  if (gap < kHalf) counts_.lost += static_cast<int>(gap);
  next_ = sequence + 1;
}

bool SequenceCounter::note(std::uint32_t sequence, Timestamp stamp) {
  note_number(sequence);
  if (last_stamp_ && stamp <= *last_stamp_) {
    ++counts_.out_of_order;
    return false;
  }
  last_stamp_ = stamp;
  ++counts_.images;
  return true;
}

void SequenceCounter::note_damaged(std::uint32_t sequence) {
  note_number(sequence);
  ++counts_.damaged;
}

ReconnectingDevice::ReconnectingDevice(const std::filesystem::path& path, const VideoRequest& request,
                                       const std::optional<double>& exposure_limit, Timestamp now)
    : path_(path), exposure_limit_(exposure_limit), last_image_(now) {
  report_.path = path.string();
  open(request);
  report_.mode = device_->mode();
  image_timeout_ = patience_for(report_.mode);
}

void ReconnectingDevice::open(const VideoRequest& request) {
  device_ = std::make_unique<VideoDevice>(path_, request);
  if (!exposure_limit_) return;
  controls_.emplace(device_->descriptor(), path_.string());
  set_exposure(report_.exposure.value_or(controls_->now()));
}

void ReconnectingDevice::reopen(Timestamp now) {
  if (now - last_attempt_ < kRetryInterval) return;
  last_attempt_ = now;
  const PixelLayout& layout = report_.mode.layout;
  VideoRequest same{layout.code, layout.width, layout.height, {}};
  if (report_.mode.rate_hz > 0.0) same.rate_hz = report_.mode.rate_hz;
  try {
    open(same);
    counter_.restart();
    last_image_ = now;
  } catch (const InputError&) {  // still away, already reported
    controls_.reset();
    device_.reset();
  }
}

void ReconnectingDevice::disconnect(const std::string& why, Timestamp now) {
  controls_.reset();
  device_.reset();
  last_attempt_ = now;
  if (disconnected_since_) return;
  disconnected_since_ = now;
  report_.is_disconnected = true;
  ++report_.disconnections;
  notes_.push_back(path_.string() + ": " + why + "; waiting for it to return");
}

void ReconnectingDevice::note_image(Timestamp now) {
  last_image_ = now;
  out_of_order_at_last_image_ = counter_.counts().out_of_order;
  if (!disconnected_since_) return;
  const double seconds = to_seconds(now - *disconnected_since_);
  report_.seconds_disconnected += seconds;
  disconnected_since_.reset();
  report_.is_disconnected = false;
  notes_.push_back(path_.string() + fmt::format(": is back after {:.1f} s", seconds));
}

std::string ReconnectingDevice::silence_reason() const {
  const char* const what = counter_.counts().out_of_order > out_of_order_at_last_image_
                               ? "its time stamps do not increase"
                               : "no image arrived";
  return what + fmt::format(" for {:.0f} s", to_seconds(image_timeout_));
}

std::vector<StampedImage> ReconnectingDevice::take(Timestamp now) {
  std::vector<StampedImage> images;
  if (!device_) reopen(now);
  for (int i = 0; device_ && i < kMaxAtOnce; ++i) {
    VideoDevice::Taken taken = device_->take();
    if (taken.outcome == VideoDevice::Outcome::nothing) break;
    if (taken.outcome == VideoDevice::Outcome::gone) {
      disconnect("was disconnected or failed", now);
      break;
    }
    if (taken.outcome == VideoDevice::Outcome::damaged) {
      counter_.note_damaged(taken.sequence);
      continue;
    }
    report_.moment = taken.moment;
    if (!counter_.note(taken.sequence, taken.image.stamp)) continue;
    note_image(now);
    images.push_back(std::move(taken.image));
  }
  if (device_ && now - last_image_ > image_timeout_) disconnect(silence_reason(), now);
  report_.counts = counter_.counts();
  return images;
}

void ReconnectingDevice::set_exposure(const CameraExposure& exposure) {
  if (!controls_) return;
  const CameraExposureLimits limits = controls_->limits(*exposure_limit_);
  report_.exposure = CameraExposure{std::clamp(exposure.seconds, limits.min_seconds, limits.max_seconds),
                                    std::min(exposure.gain, limits.max_gain)};
  controls_->set(*report_.exposure);  // a device that rejects it is detected as away
}

std::optional<CameraExposureLimits> ReconnectingDevice::exposure_limits() const {
  return controls_ ? std::optional(controls_->limits(*exposure_limit_)) : std::nullopt;
}

std::vector<std::string> ReconnectingDevice::take_notes() {
  return std::exchange(notes_, {});
}

}  // namespace byre
