#include "byre/camera/video_devices.h"

#include "byre/base/report_row.h"
#include "byre/input_error.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

std::string other_names(const fs::path& device) {
  std::string names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator("/dev/v4l/by-id", error)) {
    if (fs::weakly_canonical(entry.path(), error) == device) names += ", " + entry.path().string();
  }
  return names;
}

std::string describe_size(const VideoFormats::Size& size) {
  std::string text = fmt::format("{}{} x {}", size.is_range ? "up to " : "", size.width, size.height);
  for (std::size_t i = 0; i < size.rates_hz.size(); ++i) {
    text += (i == 0 ? " at " : ", ") + fmt::format("{:g}", size.rates_hz[i]);
  }
  return size.rates_hz.empty() ? text : text + " Hz";
}

}  // namespace

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

std::optional<VideoFormats> formats_if_camera(const fs::path& device) {
  const VideoDescriptor descriptor(device);
  try {
    return formats_of(descriptor, device.string());
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::string describe_device(const fs::path& device, const VideoFormats& formats) {
  std::string text = row("camera", device.string() + ": " + formats.name + ", " + formats.bus + other_names(device));
  for (const VideoFormats::Format& format : formats.formats) {
    const std::string unread = is_readable(format.code) ? "" : "; byre does not read it";
    text += row(("  " + four_characters(format.code)).c_str(), format.name + unread);
    for (const VideoFormats::Size& size : format.sizes) text += row("", describe_size(size));
  }
  if (formats.moment) text += row("  stamps", "of the " + std::string(to_string(*formats.moment)));
  return text;
}

}  // namespace byre
