#include "byre/camera/video_modes.h"
#include "byre/cli/camera/commands.h"
#include "byre/cli/shared/camera_options.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/input/formatted.h"
#include "byre/input_error.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <ostream>
#include <stdexcept>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kListFooter = R"(Examples:
  byre camera list
  byre camera list /dev/video0

Tells of each camera its name, where it is plugged in, its names in /dev/v4l/by-id (the same after each start), and its
formats, sizes and rates, and which moment its stamps are of. Formats that byre does not read are marked. "byre camera
show" tells what a camera really gives.

Exit codes: 0 done, 1 no camera was found, 3 a device that was named is no camera.)";

// All that Linux has for video, by number.
std::vector<fs::path> video_devices() {
  std::vector<std::pair<int, fs::path>> numbered;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator("/dev", error)) {
    const std::string name = entry.path().filename().string();
    constexpr std::string_view kPrefix = "video";
    if (!name.starts_with(kPrefix)) continue;
    const std::string number = name.substr(kPrefix.size());
    if (number.empty() || number.size() > 4 ||
        !std::ranges::all_of(number, [](char c) { return c >= '0' && c <= '9'; }))
      continue;
    numbered.emplace_back(std::stoi(number), entry.path());
  }
  std::ranges::sort(numbered);
  std::vector<fs::path> devices;
  for (const auto& [number, path] : numbered) devices.push_back(path);
  return devices;
}

std::string other_names(const fs::path& device) {
  std::string names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator("/dev/v4l/by-id", error)) {
    if (fs::weakly_canonical(entry.path(), error) == device) names += ", " + entry.path().string();
  }
  return names;
}

std::string describe_camera(const VideoFormats::Size& size) {
  std::string text = formatted(size.is_range ? "up to %d x %d" : "%d x %d", size.width, size.height);
  for (std::size_t i = 0; i < size.rates_hz.size(); ++i) {
    text += (i == 0 ? " at " : ", ") + formatted("%g", size.rates_hz[i]);
  }
  return size.rates_hz.empty() ? text : text + " Hz";
}

std::string describe_camera(const fs::path& device, const VideoFormats& formats) {
  std::string text = row("camera", device.string() + ": " + formats.name + ", " + formats.bus + other_names(device));
  for (const VideoFormats::Format& format : formats.formats) {
    const std::string unread = is_readable(format.code) ? "" : "; byre does not read it";
    text += row(("  " + four_characters(format.code)).c_str(), format.name + unread);
    for (const VideoFormats::Size& size : format.sizes) text += row("", describe_camera(size));
  }
  if (formats.moment) text += row("  stamps", "of the " + std::string(to_string(*formats.moment)));
  return text;
}

// Cameras have devices for other things beside the one for images, which nobody wants to hear of.
std::optional<VideoFormats> formats_if_camera(const fs::path& device) {
  const VideoDescriptor descriptor(device);
  try {
    return formats_of(descriptor, device.string());
  } catch (const InputError&) {
    return std::nullopt;
  }
}

ExitCode list_named(const std::vector<fs::path>& devices, std::ostream& result) {
  for (const fs::path& device : devices) {
    result << describe_camera(device, formats_of(VideoDescriptor(device), device.string()));
  }
  return ExitCode::done;
}

ExitCode list_all(std::ostream& result) {
  int found = 0;
  for (const fs::path& device : video_devices()) {
    try {
      const auto formats = formats_if_camera(device);
      if (!formats) continue;
      result << describe_camera(device, *formats);
      ++found;
    } catch (const InputError& fault) {
      result << row("no access", fault.what());
    }
  }
  if (found == 0) throw std::runtime_error("there is no camera that can be used: none of /dev/video* is one");
  return ExitCode::done;
}

}  // namespace

Action declare_camera_list(CLI::App& command) {
  const auto named = std::make_shared<std::vector<fs::path>>();
  add_text(command, "DEVICE", *named, "Cameras to tell of (all there are)")->type_name("DEVICE");
  command.footer(kListFooter);
  return [named](std::ostream& result) { return named->empty() ? list_all(result) : list_named(*named, result); };
}

}  // namespace byre::cli
