#pragma once

#include "byre/camera/exposure_control.h"
#include "byre/camera/sequence_watch.h"
#include "byre/camera/video_device.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// What came of a device so far.
struct DeviceReport {
  std::string path;
  VideoMode mode;
  StampMoment moment = StampMoment::frame_end;  // moment of the last image's stamp
  CaptureCounts counts;
  int times_away = 0;         // times that it was unplugged, or gave no image for long, and had to be opened anew
  double seconds_away = 0.0;  // without those since it went last, where it is away
  bool is_away = false;
  std::optional<CameraExposure> exposure{};  // where it is controlled
};

// A device that may be unplugged: it is opened again when it is back. Times are monotonic ones of this machine.
class WatchedDevice {
 public:
  // exposure_limit: in seconds; empty leaves the exposure to the device. Throws InputError as VideoDevice and
  // ExposureControls do.
  WatchedDevice(const std::filesystem::path& path, const VideoRequest& request,
                const std::optional<double>& exposure_limit, Timestamp now);

  // To wait for; -1 while it is away.
  int descriptor() const { return device_ ? device_->descriptor().number() : -1; }
  // Images that are waiting, in order; not so many that others would have to wait.
  std::vector<StampedImage> take(Timestamp now);
  // Takes the same exposure as other devices do; no more than its limit.
  void set_exposure(const CameraExposure& exposure);
  // Limits of exposure; empty where it is not controlled, or away.
  std::optional<CameraExposureLimits> exposure_limits() const;

  // Since it was asked last: that it is away, and that it is back.
  std::vector<std::string> take_notes();
  const DeviceReport& report() const { return report_; }

 private:
  void open(const VideoRequest& request);
  void open_again(Timestamp now);
  void lose(const std::string& why, Timestamp now);
  void note_image(Timestamp now);
  std::string why_silent() const;

  std::filesystem::path path_;            // constant after construction
  std::optional<double> exposure_limit_;  // constant after construction
  std::unique_ptr<VideoDevice> device_;   // null while it is away
  std::optional<ExposureControls> controls_;
  SequenceWatch watch_;
  Timestamp patience_{};  // longest time without an image
  Timestamp last_image_{};
  int out_of_order_at_last_image_ = 0;
  std::optional<Timestamp> away_since_;
  Timestamp last_attempt_{};
  std::vector<std::string> notes_;
  DeviceReport report_;
};

}  // namespace byre
