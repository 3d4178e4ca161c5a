#pragma once

#include "byre/camera/reconnecting_device.h"
#include "byre/camera/stamp_pairing.h"
#include "byre/image.h"
#include "byre/trajectory.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// Clock of a device's time stamps.
//   monotonic  the kernel's, which begins at boot: used by nearly all drivers
//   utc        time of day
//   own        another one, such as that of a program that feeds a virtual device
enum class CameraClock : std::uint8_t { monotonic, utc, own };

std::string_view to_string(CameraClock clock);

Timestamp monotonic_now();

// Simultaneous readings of the machine's clocks.
struct MachineTime {
  Timestamp monotonic{};
  Timestamp utc{};
};

// Best of several attempts to read both clocks together.
MachineTime machine_time();

// The clock whose reading is within ten seconds of the stamp. Flags of drivers are unreliable: some always claim
// monotonic.
CameraClock clock_of(Timestamp stamp, const MachineTime& now);

// Offset from stamps of that clock to UTC, for comparison with other sensors; zero for a clock of its own.
Timestamp utc_offset(CameraClock clock, const MachineTime& now);

// One camera, a pair in one image, or two devices whose images are paired by their stamps.
struct LiveCameraOptions {
  std::vector<std::filesystem::path> devices;  // one, or left and right
  bool side_by_side = false;                   // images of one device contain both cameras, left one first
  VideoRequest request{};                      // requested from each device
  PairingLimits pairing{};
  std::optional<double> exposure_limit_s{};  // limit if byre controls exposure and gain; empty: the device does
};

struct LiveCameraReport {
  std::vector<DeviceReport> devices;
  std::optional<CameraClock> clock;          // empty before the first image
  std::optional<StampPairCounts> pairs;      // empty for one device
  std::optional<Timestamp> last_difference;  // right stamp minus left one, of the last left image
};

// Live cameras. Use from one thread.
class LiveCameras {
 public:
  // Throws InputError like ReconnectingDevice, and for images that cannot be two halves or a pair.
  explicit LiveCameras(const LiveCameraOptions& options);

  bool has_right() const { return options_.side_by_side || devices_.size() > 1; }
  // Size of one camera's image.
  int width() const;
  int height() const;

  // Waits for an image for at most this long, and returns the complete frames. Times are UTC if the clock of the
  // devices is recognised, else the device stamps.
  std::vector<ImageFrame> wait(int milliseconds);

  std::vector<std::string> take_notes();  // events since the last call
  LiveCameraReport report() const;

 private:
  void note_clock(Timestamp stamp);
  void note_difference();
  void control_exposure(const Image& left);
  std::vector<ImageFrame> frames_of(std::vector<StampedImage> lefts, std::vector<StampedImage> rights, Timestamp now);

  LiveCameraOptions options_;                                 // constant after construction
  std::vector<std::unique_ptr<ReconnectingDevice>> devices_;  // left, right
  StampPairing pairing_;
  std::optional<CameraClock> clock_;
  Timestamp utc_offset_{};
  std::optional<CameraExposure> exposure_;  // empty until exposure is controlled
  int frames_since_exposure_ = 0;
  bool has_reported_difference_ = false;
  std::vector<std::string> notes_;
};

std::string to_text(const LiveCameraReport& report);

}  // namespace byre
