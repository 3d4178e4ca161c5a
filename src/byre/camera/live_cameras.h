#pragma once

#include "byre/camera/camera_clock.h"
#include "byre/camera/stamp_pairing.h"
#include "byre/camera/watched_device.h"
#include "byre/image.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// One camera, a pair in one image, or two devices whose images are put together by their stamps.
struct LiveCameraOptions {
  std::vector<std::filesystem::path> devices;  // one, or left and right
  bool side_by_side = false;                   // one device's images hold both cameras, the left one on the left
  VideoRequest request{};                      // what each device is asked for
  PairingLimits pairing{};
  std::optional<double> exposure_limit_s{};  // byre then controls exposure and gain; empty: the device does
};

// What came of the cameras so far.
struct LiveCameraReport {
  std::vector<DeviceReport> devices;
  std::optional<CameraClock> clock;          // empty before the first image
  std::optional<StampPairCounts> pairs;      // none for one device
  std::optional<Timestamp> last_difference;  // right stamp minus left one, of the last left image
};

// Cameras that are looked at as they come. Called by one thread.
class LiveCameras {
 public:
  // Throws InputError as WatchedDevice does, and for images that cannot be halves of two cameras or a pair.
  explicit LiveCameras(const LiveCameraOptions& options);

  bool has_right() const { return options_.side_by_side || devices_.size() > 1; }
  // Size of one camera's image.
  int width() const;
  int height() const;

  // Waits until an image comes, at most so long, and gives the frames that are complete. Times are UTC where the
  // devices' clock is known, else as the devices tell them.
  std::vector<ImageFrame> wait(int milliseconds);

  std::vector<std::string> take_notes();  // what befell the cameras since it was asked last
  LiveCameraReport report() const;

 private:
  void note_clock(Timestamp stamp);
  void note_difference();
  void control_exposure(const Image& left);
  std::vector<ImageFrame> frames_of(std::vector<StampedImage> lefts, std::vector<StampedImage> rights, Timestamp now);

  LiveCameraOptions options_;                            // constant after construction
  std::vector<std::unique_ptr<WatchedDevice>> devices_;  // left, right
  StampPairing pairing_;
  std::optional<CameraClock> clock_;
  Timestamp utc_offset_{};
  std::optional<CameraExposure> exposure_;  // empty until it is controlled
  int frames_since_exposure_ = 0;
  bool has_told_difference_ = false;
  std::vector<std::string> notes_;
};

// The report as rows of text.
std::string to_text(const LiveCameraReport& report);

}  // namespace byre
