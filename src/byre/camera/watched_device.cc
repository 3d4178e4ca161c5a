#include "byre/camera/watched_device.h"

#include "byre/input_error.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

constexpr Timestamp kRetryInterval = 200ms;
constexpr int kMostAtOnce = 8;  // images, so that other devices get their turn

// Cameras need some time from their start to the first image.
Timestamp patience_for(const VideoMode& mode) {
  constexpr Timestamp kLeast = 3s;
  constexpr double kFrames = 10.0;
  return mode.rate_hz > 0.0 ? std::max(kLeast, from_seconds(kFrames / mode.rate_hz)) : kLeast;
}

}  // namespace

WatchedDevice::WatchedDevice(const std::filesystem::path& path, const VideoRequest& request,
                             const std::optional<double>& exposure_limit, Timestamp now)
    : path_(path), exposure_limit_(exposure_limit), last_image_(now) {
  report_.path = path.string();
  open(request);
  report_.mode = device_->mode();
  patience_ = patience_for(report_.mode);
}

void WatchedDevice::open(const VideoRequest& request) {
  device_ = std::make_unique<VideoDevice>(path_, request);
  if (!exposure_limit_) return;
  controls_.emplace(device_->descriptor(), path_.string());
  set_exposure(report_.exposure.value_or(controls_->now()));
}

void WatchedDevice::open_again(Timestamp now) {
  if (now - last_attempt_ < kRetryInterval) return;
  last_attempt_ = now;
  const PixelLayout& layout = report_.mode.layout;
  VideoRequest same{layout.code, layout.width, layout.height, {}};
  if (report_.mode.rate_hz > 0.0) same.rate_hz = report_.mode.rate_hz;
  try {
    open(same);
    watch_.restart();
    last_image_ = now;
  } catch (const InputError&) {  // still away, already reported
    controls_.reset();
    device_.reset();
  }
}

void WatchedDevice::lose(const std::string& why, Timestamp now) {
  controls_.reset();
  device_.reset();
  last_attempt_ = now;
  if (away_since_) return;
  away_since_ = now;
  report_.is_away = true;
  ++report_.times_away;
  notes_.push_back(path_.string() + ": " + why + "; waiting for it to return");
}

void WatchedDevice::note_image(Timestamp now) {
  last_image_ = now;
  out_of_order_at_last_image_ = watch_.counts().out_of_order;
  if (!away_since_) return;
  const double seconds = to_seconds(now - *away_since_);
  report_.seconds_away += seconds;
  away_since_.reset();
  report_.is_away = false;
  notes_.push_back(path_.string() + fmt::format(": is back after {:.1f} s", seconds));
}

std::string WatchedDevice::why_silent() const {
  const char* const what = watch_.counts().out_of_order > out_of_order_at_last_image_
                               ? "its time stamps do not increase"
                               : "no image arrived";
  return what + fmt::format(" for {:.0f} s", to_seconds(patience_));
}

std::vector<StampedImage> WatchedDevice::take(Timestamp now) {
  std::vector<StampedImage> images;
  if (!device_) open_again(now);
  for (int i = 0; device_ && i < kMostAtOnce; ++i) {
    VideoDevice::Taken taken = device_->take();
    if (taken.outcome == VideoDevice::Outcome::nothing) break;
    if (taken.outcome == VideoDevice::Outcome::gone) {
      lose("was disconnected or failed", now);
      break;
    }
    if (taken.outcome == VideoDevice::Outcome::damaged) {
      watch_.note_damaged(taken.sequence);
      continue;
    }
    report_.moment = taken.moment;
    if (!watch_.note(taken.sequence, taken.image.stamp)) continue;
    note_image(now);
    images.push_back(std::move(taken.image));
  }
  if (device_ && now - last_image_ > patience_) lose(why_silent(), now);
  report_.counts = watch_.counts();
  return images;
}

void WatchedDevice::set_exposure(const CameraExposure& exposure) {
  if (!controls_) return;
  const CameraExposureLimits limits = controls_->limits(*exposure_limit_);
  report_.exposure = CameraExposure{std::clamp(exposure.seconds, limits.min_seconds, limits.max_seconds),
                                    std::min(exposure.gain, limits.max_gain)};
  controls_->set(*report_.exposure);  // a device that rejects it is detected as away
}

std::optional<CameraExposureLimits> WatchedDevice::exposure_limits() const {
  return controls_ ? std::optional(controls_->limits(*exposure_limit_)) : std::nullopt;
}

std::vector<std::string> WatchedDevice::take_notes() {
  return std::exchange(notes_, {});
}

}  // namespace byre
