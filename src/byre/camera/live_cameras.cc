#include "byre/camera/live_cameras.h"

#include "byre/base/enum_names.h"
#include "byre/base/report_row.h"
#include "byre/input_error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

bool is_near(Timestamp a, Timestamp b) {
  constexpr Timestamp kNear = std::chrono::seconds(10);
  return std::chrono::abs(a - b) <= kNear;
}

constexpr int kExposureInterval = 6;  // frames between changes: a change takes effect some frames later

void require_valid(const LiveCameraOptions& options) {
  if (options.devices.empty() || options.devices.size() > 2) {
    throw InputError("cameras", "must be one device or two", "give the left one, or the left and the right one");
  }
  if (options.side_by_side && options.devices.size() == 2) {
    throw InputError(options.devices[1].string(),
                     "is a second device, but the images of the first contain both cameras", "give one device");
  }
}

std::string describe(const DeviceReport& device) {
  const CaptureCounts& counts = device.counts;
  std::string text = device.path + ", " + describe(device.mode) + fmt::format(": {} images", counts.images);
  if (counts.lost > 0) text += fmt::format(", {} lost", counts.lost);
  if (counts.damaged > 0) text += fmt::format(", {} damaged", counts.damaged);
  if (counts.out_of_order > 0) text += fmt::format(", {} out of order", counts.out_of_order);
  if (device.disconnections > 0)
    text += fmt::format("; disconnected {} times for {:.1f} s", device.disconnections, device.seconds_disconnected);
  if (device.is_disconnected) text += ", still disconnected";
  if (device.exposure) {
    text += fmt::format("; exposure {:.1f} ms, gain {:.1f}", 1e3 * device.exposure->seconds, device.exposure->gain);
  }
  return text;
}

std::string describe_stamps(const LiveCameraReport& report) {
  const std::string moment(to_string(report.devices.front().moment));
  if (!report.clock) return "none received";
  return moment + std::string(name_among<CameraClock::own>(
                      {", kernel clock, converted to UTC", ", UTC", ", clock of the device"}, *report.clock));
}

}  // namespace

Timestamp monotonic_now() {
  return std::chrono::steady_clock::now().time_since_epoch();  // CLOCK_MONOTONIC, same as drivers
}

std::string_view to_string(CameraClock clock) {
  return name_among<CameraClock::own>({"monotonic", "utc", "own"}, clock);
}

MachineTime machine_time() {
  constexpr int kAttempts = 5;
  MachineTime best;
  Timestamp least = Timestamp::max();
  for (int i = 0; i < kAttempts; ++i) {
    const Timestamp before = monotonic_now();
    const Timestamp utc = std::chrono::system_clock::now().time_since_epoch();
    const Timestamp took = monotonic_now() - before;
    if (took >= least) continue;
    least = took;
    best = {before + took / 2, utc};
  }
  return best;
}

CameraClock clock_of(Timestamp stamp, const MachineTime& now) {
  if (is_near(stamp, now.monotonic)) return CameraClock::monotonic;
  return is_near(stamp, now.utc) ? CameraClock::utc : CameraClock::own;
}

Timestamp utc_offset(CameraClock clock, const MachineTime& now) {
  return clock == CameraClock::monotonic ? now.utc - now.monotonic : Timestamp{};
}

LiveCameras::LiveCameras(const LiveCameraOptions& options) : options_(options), pairing_(options.pairing) {
  require_valid(options);
  for (const std::filesystem::path& path : options.devices) {
    devices_.push_back(
        std::make_unique<ReconnectingDevice>(path, options.request, options.exposure_limit_s, monotonic_now()));
  }
  const PixelLayout& left = devices_.front()->report().mode.layout;
  const PixelLayout& right = devices_.back()->report().mode.layout;
  if (options.side_by_side && left.width % 2 != 0) {
    throw InputError(options.devices.front().string(),
                     fmt::format("has images of odd width, {} pixels, which cannot be split in halves", left.width));
  }
  if (left.width != right.width || left.height != right.height) {
    throw InputError(options.devices.back().string(), "has images of another size than the left camera",
                     "set one size for both (--size)");
  }
  exposure_ = devices_.front()->report().exposure;
}

int LiveCameras::width() const {
  const int width = devices_.front()->report().mode.layout.width;
  return options_.side_by_side ? width / 2 : width;
}

int LiveCameras::height() const {
  return devices_.front()->report().mode.layout.height;
}

void LiveCameras::note_clock(Timestamp stamp) {
  const MachineTime machine = machine_time();
  const CameraClock clock = clock_of(stamp, machine);
  if (!clock_) {
    clock_ = clock;
    utc_offset_ = byre::utc_offset(clock, machine);
  } else if (*clock_ != clock) {
    throw InputError(options_.devices.back().string(),
                     "has time stamps of another clock than the left camera, so pairs cannot be matched",
                     "use cameras of the same driver");
  }
}

void LiveCameras::note_difference() {
  constexpr int kEnough = 20;  // left images without a right one, before it is reported
  const StampPairCounts& counts = pairing_.counts();
  if (has_reported_difference_ || counts.unpaired_left < kEnough || counts.unpaired_left < counts.pairs) return;
  const auto difference = pairing_.last_difference();
  const bool is_apart = difference && std::chrono::abs(*difference) > options_.pairing.tolerance;
  if (!is_apart) return;  // right images are missing
  has_reported_difference_ = true;
  notes_.push_back(
      fmt::format("left and right images are {:.1f} ms apart, too far for a pair; trigger both cameras together, or "
                  "raise --pair-limit and accept less accurate poses",
                  1e3 * std::abs(to_seconds(*difference))));
}

void LiveCameras::control_exposure(const Image& left) {
  const auto limits = devices_.front()->exposure_limits();
  if (!exposure_ || !limits || ++frames_since_exposure_ < kExposureInterval) return;
  frames_since_exposure_ = 0;
  exposure_ = next_exposure(*exposure_, best_exposure_factor(left), *limits);
  for (const auto& device : devices_) device->set_exposure(*exposure_);
}

std::vector<ImageFrame> LiveCameras::frames_of(std::vector<StampedImage> lefts, std::vector<StampedImage> rights,
                                               Timestamp now) {
  std::vector<ImageFrame> frames;
  if (devices_.size() == 1) {
    for (StampedImage& left : lefts) {
      ImageFrame& frame = frames.emplace_back(ImageFrame{left.stamp + utc_offset_, {}, {}});
      if (options_.side_by_side) {
        ImageHalves halves = halves_of(left.image);
        frame.left = std::move(halves.left);
        frame.right = std::move(halves.right);
      } else {
        frame.left = std::move(left.image);
      }
    }
    return frames;
  }
  for (StampedImage& left : lefts) pairing_.add_left(std::move(left), now);
  for (StampedImage& right : rights) pairing_.add_right(std::move(right));
  while (auto pair = pairing_.next(now)) {
    ImageFrame& frame =
        frames.emplace_back(ImageFrame{pair->left.stamp + utc_offset_, std::move(pair->left.image), {}});
    if (pair->right) frame.right = std::move(pair->right->image);
  }
  note_difference();
  return frames;
}

std::vector<ImageFrame> LiveCameras::wait(int milliseconds) {
  std::vector<int> descriptors;
  for (const auto& device : devices_) descriptors.push_back(device->descriptor());
  wait_for_any(descriptors, milliseconds);
  const Timestamp now = monotonic_now();
  std::vector<std::vector<StampedImage>> images(2);
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    const bool is_first = devices_[i]->report().counts.images == 0;
    images[i] = devices_[i]->take(now);
    if (is_first && !images[i].empty()) note_clock(images[i].front().stamp);
  }
  std::vector<ImageFrame> frames = frames_of(std::move(images[0]), std::move(images[1]), now);
  if (!frames.empty()) control_exposure(frames.back().left);
  return frames;
}

std::vector<std::string> LiveCameras::take_notes() {
  std::vector<std::string> notes = std::exchange(notes_, {});
  for (const auto& device : devices_) std::ranges::move(device->take_notes(), std::back_inserter(notes));
  return notes;
}

LiveCameraReport LiveCameras::report() const {
  LiveCameraReport report;
  for (const auto& device : devices_) report.devices.push_back(device->report());
  report.clock = clock_;
  if (devices_.size() > 1) report.pairs = pairing_.counts();
  report.last_difference = pairing_.last_difference();
  return report;
}

std::string to_text(const LiveCameraReport& report) {
  std::string text;
  for (const DeviceReport& device : report.devices) text += row("camera", describe(device));
  text += row("stamps", describe_stamps(report));
  if (report.pairs) {
    text += row("pairs", fmt::format("{}; {} left and {} right images unpaired", report.pairs->pairs,
                                     report.pairs->unpaired_left, report.pairs->unpaired_right) +
                             (report.last_difference
                                  ? fmt::format("; the last {:.2f} ms apart", 1e3 * to_seconds(*report.last_difference))
                                  : std::string()));
  }
  return text;
}

}  // namespace byre
