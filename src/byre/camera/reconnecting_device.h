#pragma once

#include "byre/camera/exposure.h"
#include "byre/camera/video_device.h"
#include "byre/trajectory.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace byre {

struct CaptureCounts {
  int images = 0;        // images that were passed on
  int lost = 0;          // images that the driver dropped, by gaps of its sequence numbers
  int damaged = 0;       // images that the driver marks as damaged, or that are truncated
  int out_of_order = 0;  // images with a stamp not later than the previous one
};

// Counts images by a driver's sequence numbers and stamps.
class SequenceCounter {
 public:
  // Whether to pass the image on.
  bool note(std::uint32_t sequence, Timestamp stamp);
  // Advances the sequence number, so that the damaged image is not a gap.
  void note_damaged(std::uint32_t sequence);
  // The device was reopened: its sequence numbers restart.
  void restart() { next_.reset(); }

  const CaptureCounts& counts() const { return counts_; }

 private:
  void note_number(std::uint32_t sequence);

  std::optional<std::uint32_t> next_;  // expected number of the next image
  std::optional<Timestamp> last_stamp_;
  CaptureCounts counts_;
};

struct DeviceReport {
  std::string path;
  VideoMode mode;
  StampMoment moment = StampMoment::frame_end;  // moment of the last image's stamp
  CaptureCounts counts;
  // Number of times that it was unplugged, or sent no image for long, and had to be reopened.
  int disconnections = 0;
  double seconds_disconnected = 0.0;  // excludes the current absence
  bool is_disconnected = false;
  std::optional<CameraExposure> exposure{};  // empty unless controlled
};

// A device that may be unplugged; it is reopened when it returns. Times are monotonic times of this machine.
class ReconnectingDevice {
 public:
  // exposure_limit: seconds; empty leaves the exposure to the device. Throws InputError like VideoDevice and
  // ExposureControls.
  ReconnectingDevice(const std::filesystem::path& path, const VideoRequest& request,
                     const std::optional<double>& exposure_limit, Timestamp now);

  // File descriptor to wait for; -1 while the device is away.
  int descriptor() const { return device_ ? device_->descriptor().number() : -1; }
  // Waiting images in order. Their number is limited, so that other devices get their turn.
  std::vector<StampedImage> take(Timestamp now);
  // Sets an exposure chosen for all devices, clamped to its own limits.
  void set_exposure(const CameraExposure& exposure);
  // Limits of exposure; empty if it is not controlled, or the device is away.
  std::optional<CameraExposureLimits> exposure_limits() const;

  // Notes since the last call: the device went away, or returned.
  std::vector<std::string> take_notes();
  const DeviceReport& report() const { return report_; }

 private:
  void open(const VideoRequest& request);
  void reopen(Timestamp now);
  void disconnect(const std::string& why, Timestamp now);
  void note_image(Timestamp now);
  std::string silence_reason() const;

  std::filesystem::path path_;            // constant after construction
  std::optional<double> exposure_limit_;  // constant after construction
  std::unique_ptr<VideoDevice> device_;   // null while the device is away
  std::optional<ExposureControls> controls_;
  SequenceCounter counter_;
  Timestamp image_timeout_{};  // longest time without an image
  Timestamp last_image_{};
  int out_of_order_at_last_image_ = 0;
  std::optional<Timestamp> disconnected_since_;
  Timestamp last_attempt_{};
  std::vector<std::string> notes_;
  DeviceReport report_;
};

}  // namespace byre
