#pragma once

#include "byre/camera/stamp_pairing.h"
#include "byre/camera/video_descriptor.h"
#include "byre/camera/video_modes.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace byre {

// A camera that Linux knows by V4L2, streaming into memory that it shares with the driver.
class VideoDevice {
 public:
  // What came of asking for an image.
  //   image    one was there
  //   nothing  none is waiting
  //   damaged  one was there that the driver calls damaged, or that is cut
  //   gone     the device was unplugged, or gives up
  enum class Outcome : std::uint8_t { image, nothing, damaged, gone };
  struct Taken {
    Outcome outcome = Outcome::nothing;
    std::uint32_t sequence = 0;
    StampMoment moment = StampMoment::frame_end;
    StampedImage image{};  // the driver's stamp, and 8-bit grey
  };

  // Throws InputError: no device of that name, none that captures, busy, or none of its formats and sizes fits.
  VideoDevice(const std::filesystem::path& path, const VideoRequest& request);
  ~VideoDevice();
  VideoDevice(const VideoDevice&) = delete;
  VideoDevice& operator=(const VideoDevice&) = delete;

  const VideoMode& mode() const { return mode_; }
  const VideoDescriptor& descriptor() const { return descriptor_; }

  Taken take();  // waits for nothing

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
