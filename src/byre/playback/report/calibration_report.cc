#include "byre/playback/report/calibration_report.h"

#include "byre/features/stereo_quality.h"
#include "byre/geometry/degrees.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

// Change and standard errors of a parameter, in its own unit.
Json parameter_json(const RefinedCalibration& refined, int i) {
  const CalibrationParameter& parameter = calibration_parameters()[static_cast<std::size_t>(i)];
  const double sigma_before = parameter.sigma * refined.sigma_before[i];
  const double sigma_after = parameter.sigma * refined.sigma_after[i];
  return {{"name", parameter.name},
          {"unit", parameter.unit},
          {"change", parameter.sigma * refined.change[i]},
          {"sigma_before", sigma_before},
          {"sigma_after", sigma_after},
          {"determined", sigma_after < 0.5 * sigma_before}};  // refinement at least halved its standard error
}

// Refinement changed it by more than a twentieth of its standard error before.
bool is_changed(const Json& parameter) {
  return std::abs(parameter["change"].get<double>()) > 0.05 * parameter["sigma_before"].get<double>();
}

std::string change_of(const Json& parameter) {
  const auto unit = parameter["unit"].get<std::string>();
  return fmt::format("{} {:+.2g}{}{}", parameter["name"].get<std::string>(), parameter["change"].get<double>(),
                     unit.empty() ? "" : " ", unit);
}

// Length of a map unit by the wheels. Empty if the wheels set the scale, which makes it 1.
std::string describe_lengths(const WheelCalibration& wheels, const RunResult& run, bool has_metric_source) {
  const double share = 100.0 * wheels.scale_sigma();
  if (has_metric_source) {
    return fmt::format("{:.2f} % longer than by camera (sigma {:.2f} %); ", 100.0 * (wheels.metres_per_unit - 1.0),
                       share);
  }
  if (run.is_metric) return "";
  return fmt::format("a unit of the map is {:.3f} m (sigma {:.2f} %); ", wheels.metres_per_unit, share);
}

bool is_bridged(const PlayedFrame& frame) {
  return frame.report && frame.report->map_from_body && frame.report->health.doubt == DistrustReason::bridged;
}

}  // namespace

Json calibration_json(const RefinedCalibration& refined) {
  Json parameters = Json::array();
  for (int i = 0; i < kCalibrationParameters; ++i) {
    if (has_parameter(refined.calibration, i)) parameters.push_back(parameter_json(refined, i));
  }
  return {{"readout_time_s", refined.calibration.readout_time},
          {"keyframes", refined.keyframes},
          {"observations", refined.observations},
          {"shift_px", refined.shift},
          {"refused", refined.was_refused()},
          {"parameters", parameters}};
}

std::string describe_calibration(const RefinedCalibration& refined) {
  const Json figures = calibration_json(refined);
  Json changed = Json::array();
  for (const Json& parameter : figures["parameters"]) {
    if (is_changed(parameter)) changed.push_back(change_of(parameter));
  }
  return expand(
             "[{!keyframes}as given, except for baseline length or readout time"
             "|{?refused}as given; refinement from {keyframes} keyframes rejected: change of {shift_px:.2f} px"
             "|{!is_moved}as given, confirmed by {keyframes} keyframes"
             "|refined from {keyframes} keyframes, by {shift_px:.2f} px (root mean square)[{?changed}: {changed}]]"
             "[{?readout_time_s}; rolling shutter, readout time {readout_time_s*1e3:.1f} ms]",
             figures, {{"is_moved", !refined.change.isZero(0.0)}, {"changed", changed}})
      .value();
}

void add_calibration(const RefinedCalibration& refined, Report& report) {
  report.row("calibration", "{calibration}", {{"calibration", describe_calibration(refined)}});
  if (refined.keyframes == 0) return;
  for (Json parameter : calibration_json(refined)["parameters"]) {
    parameter["changed"] = is_changed(parameter);
    report.line(
        "  {name:28} {change:+11.5f} {unit:3}  sigma {sigma_before:.5f} before, {sigma_after:.5f} now"
        "[{!changed} (as given)]",
        parameter);
  }
}

std::optional<std::string> calibration_warning(const std::optional<RefinedCalibration>& refined,
                                               const std::optional<double>& row_error) {
  if (refined && refined->is_implausible()) {
    return fmt::format(
        "the calibration is not of these cameras: refinement from {} keyframes would change it by {:.2f} px, more than "
        "plausible calibration errors; it is used unchanged. Check resolution and focal length, and calibrate the "
        "cameras again",
        refined->keyframes, refined->shift);
  }
  if (!row_error || *row_error <= kMaxCommonRowError) return std::nullopt;
  const bool is_refined = refined && !refined->was_refused();
  return fmt::format("the calibration has an error of about {:.2f} px (row differences of the pair): ", *row_error) +
         (is_refined ? "calibrate the cameras again, or use a calibration by \"byre calibrate\""
                     : "calibrate the cameras again");
}

void add_motion(const RunResult& run, bool has_metric_source, Report& report) {
  const MotionEstimates& motion = run.motion;
  if (!motion.has_samples) return;
  if (motion.wheels) {
    const Eigen::Vector3d& arm = motion.wheels->base_from_body.translation;
    report.row(
        "wheels",
        "body {ahead_m:.2f} m ahead and {left_m:.2f} m to the left of the base; time offset {offset_s*1e3:.0f} ms "
        "to the images; {lengths}ignored {slips} times for slip[{?has_changed}; motions "
        "contradict the given extrinsics]",
        {{"ahead_m", arm.x()},
         {"left_m", arm.y()},
         {"offset_s", motion.time_offset},
         {"lengths", describe_lengths(*motion.wheels, run, has_metric_source)},
         {"slips", motion.slips},
         {"has_changed", motion.has_calibration_changed}});
  }
  if (motion.gyroscope) {
    report.row("gyroscope", "bias {bias:.3f} deg/s", {{"bias", list_json(motion.gyroscope->bias / kDegree)}});
  }
  const auto& up = motion.calibration_to_store.up;
  report.row("gravity",
             "{?stops}{stops} stops, {standstill_s:.1f} s[; vertical in the map with sigma {up_sigma_deg:.1f} deg]; "
             "roll and pitch of {tilts} bridged frames corrected",
             {{"stops", motion.stops},
              {"standstill_s", motion.standstill_s},
              {"up_sigma_deg", up ? nlohmann::ordered_json(up->sigma / kDegree) : nullptr},
              {"tilts", motion.tilts_applied}});
  if (!motion.wheels && motion.has_calibration_changed) {
    report.row("wheels", "not used: motions contradict the given extrinsics, and others are not estimated yet");
  } else if (!motion.wheels && !motion.gyroscope) {
    return report.row("motion", "not used: too little motion to estimate the extrinsics");
  }
  report.row("bridged", "{bridged} frames without visual pose; {filled} further frames have a final pose by wheels",
             {{"bridged", std::ranges::count_if(run.frames, is_bridged)}, {"filled", motion.filled_poses}});
}

}  // namespace byre
