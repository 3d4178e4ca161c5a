#pragma once

#include "byre/camera/video_modes.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// All that Linux has for video, by number: of a camera the device for images, and those for other things.
std::vector<std::filesystem::path> video_devices();

// What a device offers; empty for one that is no camera's device for images. Throws InputError where it may not be
// opened.
std::optional<VideoFormats> formats_if_camera(const std::filesystem::path& device);

// Rows of a report: name, where it is plugged in, its names that stay the same, formats with sizes and rates, and which
// moment its stamps are of. Formats that are not read are marked.
std::string describe_device(const std::filesystem::path& device, const VideoFormats& formats);

}  // namespace byre
