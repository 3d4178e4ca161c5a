#include "byre/playback/report/motion_report.h"

#include "byre/geometry/degrees.h"
#include "byre/playback/report/report_json.h"

#include <algorithm>

#include <fmt/core.h>

namespace byre {
namespace {

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
