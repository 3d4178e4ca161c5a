#include "byre/cli/simulate/imperfection_options.h"

#include "byre/cli/shared/choice.h"
#include "byre/cli/shared/number_check.h"

#include <map>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

template <typename Number>
void add_number(CLI::App& command, const char* name, std::optional<Number>& value, std::pair<double, double> range,
                const char* unit, const char* meaning) {
  command.add_option(name, value, meaning)
      ->type_name(unit)
      ->check(between(range.first, range.second))
      ->group("Camera errors");
}

// Converts a given number to another unit; without one keeps the value.
template <typename Number>
void replace(Number& value, const std::optional<Number>& given, Number per_unit = 1) {
  if (given) value = *given * per_unit;
}

}  // namespace

void declare_imperfection(CLI::App& command, ImperfectionOptions& options) {
  std::map<std::string, CameraCondition> conditions;
  for (const CameraCondition condition : {CameraCondition::exact, CameraCondition::good, CameraCondition::worn}) {
    conditions.emplace(to_string(condition), condition);
  }
  command.add_option("--imperfection", options.condition, "Preset of all camera errors by age and use (exact)")
      ->type_name("exact|good|worn")
      ->transform(one_of(conditions))
      ->group("Camera errors");
  add_number(command, "--calibration-level", options.calibration_level, {0.0, 10.0}, "NUMBER",
             "Size of the calibration error: 1 for a good calibration, 3 for a worn camera");
  command.add_option("--calibration-seed", options.calibration_seed, "Seed of the calibration error (1)")
      ->type_name("N")
      ->group("Camera errors");
  add_number(command, "--rolling-shutter", options.rolling_shutter_ms, {0.0, 100.0}, "MS",
             "Rolling shutter: readout time of an image");
  add_number(command, "--time-offset", options.time_offset_ms, {-100.0, 100.0}, "MS",
             "Delay of the right camera's exposure");
  add_number(command, "--lens-blur", options.lens_blur, {0.0, 5.0}, "PX",
             "Standard deviation of the blur in the corners of left images; 1.5 times as much in right images");
  add_number(command, "--gain", options.gain, {0.25, 4.0}, "NUMBER",
             "Gain of the right camera relative to the left one");
  add_number(command, "--offset", options.offset, {-50.0, 50.0}, "GREY", "Offset of the right camera, grey values");
  add_number(command, "--vignetting", options.vignetting, {0.0, 0.9}, "SHARE",
             "Vignetting: share of the light lost in the corners");
  add_number(command, "--jpeg", options.jpeg_quality, {1, 100}, "QUALITY",
             "Quality of JPEG compression, before images are stored as PNG");
}

CameraImperfection make_imperfection(const ImperfectionOptions& options) {
  constexpr double kSecondsPerMillisecond = 1e-3;
  CameraImperfection imperfection = imperfection_of(options.condition.value_or(CameraCondition::exact));
  replace(imperfection.calibration_level, options.calibration_level);
  replace(imperfection.calibration_seed, options.calibration_seed);
  replace(imperfection.rolling_shutter_s, options.rolling_shutter_ms, kSecondsPerMillisecond);
  replace(imperfection.time_offset_s, options.time_offset_ms, kSecondsPerMillisecond);
  replace(imperfection.lens_blur, options.lens_blur);
  replace(imperfection.gain, options.gain);
  replace(imperfection.offset, options.offset);
  replace(imperfection.vignetting, options.vignetting);
  replace(imperfection.jpeg_quality, options.jpeg_quality);
  return imperfection;
}

}  // namespace byre::cli
