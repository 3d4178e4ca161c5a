#pragma once

#include "byre/camera/pixel_layout.h"
#include "byre/camera/video_descriptor.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// What a device is asked for; what is empty is left as it is set, or chosen.
struct VideoRequest {
  std::optional<std::uint32_t> format{};  // four characters
  std::optional<int> width{};             // pixels; goes with height
  std::optional<int> height{};            // pixels
  std::optional<double> rate_hz{};
};

// What a device does.
struct VideoMode {
  PixelLayout layout;
  double rate_hz = 0.0;  // zero: not told
};

// "752 x 480 GREY at 20 Hz".
std::string describe(const VideoMode& mode);

// When the driver reads the clock for an image's stamp.
enum class StampMoment : std::uint8_t { exposure_start, frame_end };

std::string_view to_string(StampMoment moment);

// By the flags of a buffer (linux/videodev2.h).
StampMoment moment_of(std::uint32_t flags);

// What a device says of itself.
struct VideoFormats {
  struct Size {
    int width = 0;          // pixels
    int height = 0;         // pixels
    bool is_range = false;  // any size up to this one
    std::vector<double> rates_hz{};
  };
  struct Format {
    std::uint32_t code = 0;
    std::string name;
    std::vector<Size> sizes{};
  };
  std::string name;
  std::string bus;  // where it is plugged in: the same after it was unplugged and plugged in again
  std::vector<Format> formats{};
  std::optional<StampMoment> moment{};  // empty where it is not told, as while another program uses the device
};

// Throws InputError for what is no camera.
VideoFormats formats_of(const VideoDescriptor& descriptor, const std::string& place);

// Sets a device to what is asked for, and tells what it then does. Of formats that are left open the first one in the
// order of preference that gives size and rate. Throws InputError, with what the device offers, when none does.
VideoMode set_mode(const VideoDescriptor& descriptor, const VideoRequest& request, const std::string& place);

}  // namespace byre
