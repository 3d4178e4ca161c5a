#pragma once

#include "byre/camera/pixel_layout.h"
#include "byre/camera/video_descriptor.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// Requested mode of a device; empty members keep the current setting, or are chosen.
struct VideoRequest {
  std::optional<std::uint32_t> format{};  // four characters
  std::optional<int> width{};             // pixels; goes with height
  std::optional<int> height{};            // pixels
  std::optional<double> rate_hz{};
};

// Actual mode of a device.
struct VideoMode {
  PixelLayout layout;
  double rate_hz = 0.0;  // zero: unknown
};

// Text such as "752 x 480 GREY at 20 Hz".
std::string describe(const VideoMode& mode);

// Moment at which the driver reads the clock for an image's stamp.
enum class StampMoment : std::uint8_t { exposure_start, frame_end };

std::string_view to_string(StampMoment moment);

// From the flags of a buffer (linux/videodev2.h).
StampMoment moment_of(std::uint32_t flags);

// Capabilities reported by a device.
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
  std::string bus;  // bus address; the same after replugging
  std::vector<Format> formats{};
  std::optional<StampMoment> moment{};  // empty if unknown, such as while another program uses the device
};

// Throws InputError if it is not a camera.
VideoFormats formats_of(const VideoDescriptor& descriptor, const std::string& place);

// Sets the requested mode, and returns the actual one. Formats that the request leaves open are tried in order of
// preference, until size and rate fit. Throws InputError with the device's capabilities if none fits.
VideoMode set_mode(const VideoDescriptor& descriptor, const VideoRequest& request, const std::string& place);

// All video devices of Linux by number; those of a camera include devices for other data than images.
std::vector<std::filesystem::path> video_devices();

// Formats of a device; empty if it is not a camera's image device. Throws InputError if it cannot be opened.
std::optional<VideoFormats> formats_if_camera(const std::filesystem::path& device);

// Rows of a report: name, bus, persistent names, formats with sizes and rates, and the moment of its stamps. Unreadable
// formats are marked.
std::string describe_device(const std::filesystem::path& device, const VideoFormats& formats);

}  // namespace byre
