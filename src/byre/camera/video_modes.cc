#include "byre/camera/video_modes.h"

#include "byre/base/report_row.h"
#include "byre/input_error.h"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <fmt/core.h>
#include <linux/videodev2.h>

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

constexpr int kMaxListed = 256;  // entries, because some drivers list without end
constexpr const char* kSeeList = "\"byre camera list\" lists its formats";

double rate_of(const v4l2_fract& interval) {
  return interval.numerator > 0 ? double{1.0} * interval.denominator / interval.numerator : 0.0;
}

std::vector<double> rates_of(const VideoDescriptor& descriptor, std::uint32_t code, int width, int height) {
  std::vector<double> rates;
  for (int i = 0; i < kMaxListed; ++i) {
    v4l2_frmivalenum interval{};
    interval.index = static_cast<std::uint32_t>(i);
    interval.pixel_format = code;
    interval.width = static_cast<std::uint32_t>(width);
    interval.height = static_cast<std::uint32_t>(height);
    if (!descriptor.call(VIDIOC_ENUM_FRAMEINTERVALS, &interval)) break;
    if (interval.type != V4L2_FRMIVAL_TYPE_DISCRETE) {
      rates.push_back(rate_of(interval.stepwise.min));
      break;
    }
    rates.push_back(rate_of(interval.discrete));
  }
  return rates;
}

std::vector<VideoFormats::Size> sizes_of(const VideoDescriptor& descriptor, std::uint32_t code) {
  std::vector<VideoFormats::Size> sizes;
  for (int i = 0; i < kMaxListed; ++i) {
    v4l2_frmsizeenum size{};
    size.index = static_cast<std::uint32_t>(i);
    size.pixel_format = code;
    if (!descriptor.call(VIDIOC_ENUM_FRAMESIZES, &size)) break;
    const bool is_range = size.type != V4L2_FRMSIZE_TYPE_DISCRETE;
    const int width = static_cast<int>(is_range ? size.stepwise.max_width : size.discrete.width);
    const int height = static_cast<int>(is_range ? size.stepwise.max_height : size.discrete.height);
    sizes.push_back({width, height, is_range, rates_of(descriptor, code, width, height)});
    if (is_range) break;
  }
  return sizes;
}

v4l2_capability capability_of(const VideoDescriptor& descriptor, const std::string& place) {
  v4l2_capability capability{};
  if (!descriptor.call(VIDIOC_QUERYCAP, &capability)) {
    throw InputError(place, "is not a camera", "\"byre camera list\" lists the cameras");
  }
  const bool has_device_caps = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0;
  const std::uint32_t does = has_device_caps ? capability.device_caps : capability.capabilities;
  if ((does & V4L2_CAP_VIDEO_CAPTURE) == 0 || (does & V4L2_CAP_STREAMING) == 0) {
    throw InputError(place, "does not support streaming by memory mapping",
                     "give another device of the camera, see \"byre camera list\"");
  }
  return capability;
}

std::vector<std::uint32_t> offered_formats(const VideoDescriptor& descriptor) {
  std::vector<std::uint32_t> codes;
  for (int i = 0; i < kMaxListed; ++i) {
    v4l2_fmtdesc format{};
    format.index = static_cast<std::uint32_t>(i);
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (!descriptor.call(VIDIOC_ENUM_FMT, &format)) break;
    codes.push_back(format.pixelformat);
  }
  return codes;
}

// Formats to try, best first. Throws InputError if there is none.
std::vector<std::uint32_t> formats_to_try(const VideoDescriptor& descriptor, const VideoRequest& request,
                                          const std::string& place) {
  if (request.format && !is_readable(*request.format)) {
    throw InputError(place, "is set to " + four_characters(*request.format) + ", which byre does not read",
                     "use one of " + readable_formats());
  }
  if (request.format) return {*request.format};
  std::vector<std::uint32_t> codes = offered_formats(descriptor);
  std::string offered;
  for (const std::uint32_t code : codes) offered += (offered.empty() ? "" : ", ") + four_characters(code);
  std::erase_if(codes, [](std::uint32_t code) { return !is_readable(code); });
  if (codes.empty()) {
    throw InputError(place, "has no format that byre reads, only " + (offered.empty() ? "none" : offered),
                     "set its driver to one of " + readable_formats());
  }
  std::ranges::sort(codes, {}, [](std::uint32_t code) { return *preference_of(code); });
  return codes;
}

double set_rate(const VideoDescriptor& descriptor, const std::optional<double>& rate_hz) {
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (!descriptor.call(VIDIOC_G_PARM, &parameters)) return 0.0;
  if (rate_hz) {
    constexpr std::uint32_t kThousand = 1000;
    parameters.parm.capture.timeperframe = {kThousand, static_cast<std::uint32_t>(*rate_hz * kThousand + 0.5)};
    descriptor.call(VIDIOC_S_PARM, &parameters);  // the rate returned below shows the result
  }
  return rate_of(parameters.parm.capture.timeperframe);
}

// The actual mode after a request with this format; empty if the device rejects it.
std::optional<VideoMode> try_mode(const VideoDescriptor& descriptor, const VideoRequest& request, std::uint32_t code) {
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (!descriptor.call(VIDIOC_G_FMT, &format)) return std::nullopt;
  v4l2_pix_format& pixels = format.fmt.pix;
  pixels.pixelformat = code;
  pixels.field = V4L2_FIELD_NONE;
  pixels.bytesperline = 0;
  pixels.sizeimage = 0;
  if (request.width) pixels.width = static_cast<std::uint32_t>(*request.width);
  if (request.height) pixels.height = static_cast<std::uint32_t>(*request.height);
  if (!descriptor.call(VIDIOC_S_FMT, &format) || pixels.pixelformat != code) return std::nullopt;
  VideoMode mode;
  mode.layout = {code, static_cast<int>(pixels.width), static_cast<int>(pixels.height), pixels.bytesperline};
  mode.rate_hz = set_rate(descriptor, request.rate_hz);
  return mode;
}

bool fits_request(const VideoMode& mode, const VideoRequest& request) {
  constexpr double kNearly = 0.98;  // accepts 29.97 Hz for 30 Hz
  const bool has_size = mode.layout.width == request.width.value_or(mode.layout.width) &&
                        mode.layout.height == request.height.value_or(mode.layout.height);
  return has_size && (!request.rate_hz || mode.rate_hz >= kNearly * *request.rate_hz);
}

// Drivers report the moment of stamps with the first buffer.
std::optional<StampMoment> reported_moment(const VideoDescriptor& descriptor) {
  v4l2_requestbuffers wanted{};
  wanted.count = 1;
  wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  wanted.memory = V4L2_MEMORY_MMAP;
  if (!descriptor.call(VIDIOC_REQBUFS, &wanted)) return std::nullopt;
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  const bool is_told = descriptor.call(VIDIOC_QUERYBUF, &buffer);
  wanted.count = 0;
  descriptor.call(VIDIOC_REQBUFS, &wanted);  // releases the buffer
  return is_told ? std::optional(moment_of(buffer.flags)) : std::nullopt;
}

}  // namespace

std::string_view to_string(StampMoment moment) {
  return moment == StampMoment::exposure_start ? "start of exposure" : "end of frame";
}

StampMoment moment_of(std::uint32_t flags) {
  const bool is_start = (flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  return is_start ? StampMoment::exposure_start : StampMoment::frame_end;
}

std::string describe(const VideoMode& mode) {
  const PixelLayout& layout = mode.layout;
  const std::string text = fmt::format("{} x {} ", layout.width, layout.height) + four_characters(layout.code);
  return mode.rate_hz > 0.0 ? text + fmt::format(" at {:g} Hz", mode.rate_hz) : text;
}

VideoFormats formats_of(const VideoDescriptor& descriptor, const std::string& place) {
  const v4l2_capability capability = capability_of(descriptor, place);
  VideoFormats formats;
  formats.name = reinterpret_cast<const char*>(capability.card);
  formats.bus = reinterpret_cast<const char*>(capability.bus_info);
  for (int i = 0; i < kMaxListed; ++i) {
    v4l2_fmtdesc format{};
    format.index = static_cast<std::uint32_t>(i);
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (!descriptor.call(VIDIOC_ENUM_FMT, &format)) break;
    formats.formats.push_back({format.pixelformat, reinterpret_cast<const char*>(format.description),
                               sizes_of(descriptor, format.pixelformat)});
  }
  formats.moment = reported_moment(descriptor);
  return formats;
}

VideoMode set_mode(const VideoDescriptor& descriptor, const VideoRequest& request, const std::string& place) {
  capability_of(descriptor, place);
  std::string tried;
  for (const std::uint32_t code : formats_to_try(descriptor, request, place)) {
    errno = 0;
    const auto mode = try_mode(descriptor, request, code);
    if (mode && fits_request(*mode, request)) return *mode;
    if (!mode && errno == EBUSY) {
      throw InputError(place, "is used by another program", "stop that program first");
    }
    tried += (tried.empty() ? "" : ", ") + (mode ? describe(*mode) : four_characters(code) + " unavailable");
  }
  std::string asked;
  if (request.width && request.height) asked += fmt::format(" of {} x {} pixels", *request.width, *request.height);
  if (request.rate_hz) asked += fmt::format(" at {:g} Hz", *request.rate_hz);
  throw InputError(place, "delivers no images" + asked + ", available: " + tried, kSeeList);
}

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
