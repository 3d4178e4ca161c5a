#include "byre/cli/shared/camera_options.h"

#include "byre/base/text_file.h"
#include "byre/cli/shared/arguments.h"

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

constexpr int kLongestSide = 1 << 15;  // pixels

std::optional<int> parse_side(std::string_view text) {
  const std::optional<double> side = parse_number(text);
  const bool is_sound = side && *side >= 1 && *side <= kLongestSide && *side == static_cast<int>(*side);
  return is_sound ? std::optional(static_cast<int>(*side)) : std::nullopt;
}

}  // namespace

LiveCameraOptions CameraOptions::live() const {
  LiveCameraOptions options;
  options.devices = devices;
  options.side_by_side = side_by_side;
  options.request = request;
  options.pairing.tolerance = from_seconds(pair_limit_ms / 1e3);
  if (exposure_limit_ms) options.exposure_limit_s = *exposure_limit_ms / 1e3;
  return options;
}

std::string CameraOptions::name() const {
  std::string text;
  for (const std::filesystem::path& device : devices) text += (text.empty() ? "" : " and ") + device.string();
  return text;
}

void declare_camera_options(CLI::App& command, CameraOptions& options, CLI::Option* devices) {
  const auto set_size = [&options](const std::string& text) {
    const std::size_t by = text.find('x');
    options.request.width = parse_side(std::string_view(text).substr(0, by));
    options.request.height = by == std::string::npos ? std::nullopt : parse_side(std::string_view(text).substr(by + 1));
    if (options.request.width && options.request.height) return;
    throw CLI::ValidationError("--size", "\"" + text + "\" is not a size such as 1280x720");
  };
  const auto set_format = [&options](const std::string& text) {
    options.request.format = parse_four_characters(text);
    if (options.request.format && is_readable(*options.request.format)) return;
    throw CLI::ValidationError("--pixel-format", "\"" + text + "\" is not one of " + readable_formats());
  };
  const auto let_need = [devices](CLI::Option* option) {
    if (!devices->get_required()) option->needs(devices);
  };
  let_need(command.add_flag("--side-by-side", options.side_by_side,
                            "Each image holds both cameras of a pair, the left one in its left half"));
  let_need(command
               .add_option_function<std::string>("--size", set_size,
                                                 "Image size of the device, pixels (its current setting)")
               ->type_name("WIDTHxHEIGHT"));
  let_need(command.add_option("--rate", options.request.rate_hz, "Frame rate of the device (its current setting)")
               ->type_name("HZ")
               ->check(between(0.1, 10'000.0)));
  let_need(command
               .add_option_function<std::string>("--pixel-format", set_format,
                                                 "Pixel format of the device (the best of " + readable_formats() + ")")
               ->type_name("FORMAT"));
  let_need(command
               .add_option("--pair-limit", options.pair_limit_ms,
                           "Maximum time between the two images of a pair from two devices")
               ->type_name("MS")
               ->check(between(0.0, 1000.0))
               ->capture_default_str());
  let_need(command
               .add_option("--exposure-limit", options.exposure_limit_ms,
                           "Longest exposure time: byre controls exposure and gain so that corners are found all over "
                           "the image (default: control by the device)")
               ->type_name("MS")
               ->check(between(0.1, 10'000.0)));
}

}  // namespace byre::cli
