#pragma once

#include "byre/camera/video_modes.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// All video devices of Linux by number; those of a camera include devices for other data than images.
std::vector<std::filesystem::path> video_devices();

// Formats of a device; empty if it is not a camera's image device. Throws InputError if it cannot be opened.
std::optional<VideoFormats> formats_if_camera(const std::filesystem::path& device);

// Rows of a report: name, bus, persistent names, formats with sizes and rates, and the moment of its stamps. Unreadable
// formats are marked.
std::string describe_device(const std::filesystem::path& device, const VideoFormats& formats);

}  // namespace byre
