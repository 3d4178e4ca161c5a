#pragma once

#include "byre/camera/stamp_pairing.h"
#include "byre/camera/video_descriptor.h"
#include "byre/camera/video_modes.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace byre {

// A V4L2 camera that streams into memory shared with the driver.
class VideoDevice {
 public:
  // Result of taking an image.
  //   image    success
  //   nothing  no image is waiting
  //   damaged  the driver marks the image as damaged, or it is truncated
  //   gone     the device was unplugged, or failed
  enum class Outcome : std::uint8_t { image, nothing, damaged, gone };
  struct Taken {
    Outcome outcome = Outcome::nothing;
    std::uint32_t sequence = 0;
    StampMoment moment = StampMoment::frame_end;
    StampedImage image{};  // the driver's stamp, and 8-bit grey
  };

  // Throws InputError if the device does not exist, does not capture, is busy, or has no fitting format and size.
  VideoDevice(const std::filesystem::path& path, const VideoRequest& request);
  ~VideoDevice();
  VideoDevice(const VideoDevice&) = delete;
  VideoDevice& operator=(const VideoDevice&) = delete;

  const VideoMode& mode() const { return mode_; }
  const VideoDescriptor& descriptor() const { return descriptor_; }

  Taken take();  // does not wait

 private:
  void map_buffers();
  void start();
  void stop();

  std::filesystem::path path_;  // constant after construction
  VideoDescriptor descriptor_;
  VideoMode mode_;                                // constant after construction
  std::vector<std::span<std::uint8_t>> buffers_;  // memory of the driver
};

}  // namespace byre
