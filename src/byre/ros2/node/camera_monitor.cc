#include "byre/ros2/node/camera_monitor.h"

#include <algorithm>

#include <fmt/core.h>

namespace byre {
namespace {

using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;

constexpr std::byte kWarn = ros::DiagnosticStatus::kWarn;
constexpr std::byte kError = ros::DiagnosticStatus::kError;
constexpr std::byte kStale = ros::DiagnosticStatus::kStale;

constexpr Timestamp kRecently = 1s;
constexpr Timestamp kRemembered = 10s;  // shows past faults to a late observer

}  // namespace

void CameraMonitor::note_arrival(Timestamp now) {
  if (last_arrival_) {
    const Timestamp passed = now - *last_arrival_;
    if (passed < kRecently) interval_ = interval_ == Timestamp{} ? passed : (9 * interval_ + passed) / 10;
  }
  last_arrival_ = now;
  ++arrived_;
}

void CameraMonitor::note_unusable(const InputError& fault, Timestamp now) {
  unusable_ = Note{now, fault.what()};
}

void CameraMonitor::note_frame(const CameraFrame& frame, Timestamp now) {
  frames_.push_back({now, frame.expects_second && !frame.has_second, frame.seconds, frame.nearest_second});
  if (frame.is_frozen) frozen_ = Note{now, "repeated image; restart the camera driver"};
  if (frame.jump) {
    jump_ =
        Note{now, fmt::format("time stamps jumped by {:.3f} s; synchronise the clocks of camera and computer (chrony)",
                              to_seconds(*frame.jump))};
  }
  if (is_dropped(frame.fault) || frame.fault == InputFault::late_right) {
    dropped_ = Note{now, "image not used: " + std::string(to_string(frame.fault))};
  }
  drop_before(now - kRecently);
}

void CameraMonitor::note_skipped(int total, Timestamp now) {
  for (; skipped_ < total; ++skipped_) skipped_times_.push_back(now);
  drop_before(now - kRecently);
}

void CameraMonitor::drop_before(Timestamp time) {
  while (!frames_.empty() && frames_.front().time < time) frames_.pop_front();
  while (!skipped_times_.empty() && skipped_times_.front() < time) skipped_times_.pop_front();
}

// Grows with the interval of slow cameras.
Timestamp CameraMonitor::longest_silence() const {
  return std::max<Timestamp>(500ms, 3 * interval_);
}

std::optional<CameraMonitor::Finding> CameraMonitor::silence(Timestamp now) const {
  const double silent = to_seconds(now - last_arrival_.value_or(since_));
  if (!last_arrival_) {
    if (silent < 1.0) return std::nullopt;
    return Finding{kStale, "no images on " + topic_ + "; check the camera driver, the topic and ROS_DOMAIN_ID"};
  }
  if (silent < to_seconds(longest_silence())) return std::nullopt;
  return Finding{kStale, fmt::format("no image for {:.1f} s on ", silent) + topic_};
}

std::optional<CameraMonitor::Finding> CameraMonitor::lost_second_images() const {
  const auto lacking = std::ranges::count_if(frames_, &Recent::lacks_second);
  if (lacking == 0) return std::nullopt;
  std::string text = fmt::format("{} images are missing: {} of the last {}", second_, static_cast<int>(lacking),
                                 static_cast<int>(frames_.size()));
  // Stamps of unsynchronised cameras differ.
  constexpr Timestamp kLikelyItsOwn = 50ms;
  if (const auto nearest = frames_.back().nearest_second; nearest && *nearest < kLikelyItsOwn) {
    text += fmt::format(", the nearest time stamp differs by {:.1f} ms, see images.pair_tolerance",
                        1e3 * to_seconds(*nearest));
  }
  return Finding{lacking == std::ssize(frames_) ? kError : kWarn, text};
}

std::vector<CameraMonitor::Finding> CameraMonitor::findings(Timestamp now) const {
  std::vector<Finding> found;
  const auto add = [&](std::byte level, const std::optional<Note>& note, Timestamp age) {
    if (note && now - note->time < age) found.push_back({level, note->text});
  };
  add(kError, unusable_, kRecently);
  if (const auto finding = silence(now)) found.push_back(*finding);
  add(kError, frozen_, kRecently);
  if (const auto finding = lost_second_images()) found.push_back(*finding);
  add(kWarn, jump_, kRemembered);
  add(kWarn, dropped_, kRecently);
  if (!skipped_times_.empty()) {
    found.push_back({kWarn, fmt::format("{} images of the last second were replaced by newer ones",
                                        static_cast<int>(skipped_times_.size()))});
  }
  return found;
}

ros::DiagnosticStatus CameraMonitor::status(Timestamp now) const {
  ros::DiagnosticStatus status;
  status.name = "byre: cameras";
  for (const Finding& finding : findings(now)) {
    status.level = std::max(status.level, finding.level);
    status.message += (status.message.empty() ? "" : "; ") + finding.text;
  }
  if (status.message.empty()) {
    status.message = fmt::format("{} frames per second", static_cast<int>(frames_.size()));
  }
  status.hardware_id = topic_;
  double slowest = 0.0;
  for (const Recent& frame : frames_) slowest = std::max(slowest, frame.seconds);
  status.values = {{"images", std::to_string(arrived_)},
                   {"images left out", std::to_string(skipped_)},
                   {"frames in the last second", std::to_string(frames_.size())},
                   {"slowest of these, ms", fmt::format("{:.1f}", 1e3 * slowest)}};
  return status;
}

}  // namespace byre
