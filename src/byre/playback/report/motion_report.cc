#include "byre/playback/report/motion_report.h"

#include "byre/base/report_row.h"
#include "byre/geometry/degrees.h"

#include <algorithm>

#include <fmt/core.h>

namespace byre {
namespace {

// Length of a map unit by the wheels. Empty if the wheels set the scale, which makes it 1.
std::string describe_lengths(const WheelCalibration& wheels, const MapRun& run, bool has_metric_source) {
  const double share = 100.0 * wheels.scale_sigma;
  if (has_metric_source) {
    return fmt::format("{:.2f} % longer than by camera (sigma {:.2f} %); ", 100.0 * (wheels.metres_per_unit - 1.0),
                       share);
  }
  if (run.is_metric) return "";
  return fmt::format("a unit of the map is {:.3f} m (sigma {:.2f} %); ", wheels.metres_per_unit, share);
}

std::string describe(const WheelCalibration& wheels, const MapRun& run, bool has_metric_source) {
  const MotionEstimates& motion = run.motion;
  const Eigen::Vector3d& arm = wheels.base_from_body.translation;
  std::string text =
      fmt::format("body {:.2f} m ahead and {:.2f} m to the left of the base; time offset {:.0f} ms to the images; ",
                  arm.x(), arm.y(), 1e3 * motion.time_offset);
  text += describe_lengths(wheels, run, has_metric_source);
  text += fmt::format("ignored {} times for slip", motion.slips);
  return text + (motion.has_calibration_changed ? "; extrinsics differ from those of the map" : "");
}

std::string describe_stops(const MotionEstimates& motion) {
  std::string text = fmt::format("{} stops, {:.1f} s", motion.stops, motion.standstill_s);
  if (motion.calibration_to_store.up)
    text += fmt::format("; vertical in the map with sigma {:.1f} deg", motion.calibration_to_store.up->sigma / kDegree);
  return text + fmt::format("; roll and pitch of {} bridged frames corrected", motion.tilts_applied);
}

bool is_bridged(const MappedFrame& frame) {
  return frame.report && frame.report->map_from_body && frame.report->health.doubt == DistrustReason::bridged;
}

}  // namespace

std::string motion_rows(const MapRun& run, bool has_metric_source) {
  const MotionEstimates& motion = run.motion;
  if (!motion.has_samples) return "";
  std::string text;
  if (motion.wheels) text += row("wheels", describe(*motion.wheels, run, has_metric_source));
  if (motion.gyroscope) {
    text += row("gyroscope", fmt::format("bias {:.3f}, {:.3f}, {:.3f} deg/s", motion.gyroscope->bias.x() / kDegree,
                                         motion.gyroscope->bias.y() / kDegree, motion.gyroscope->bias.z() / kDegree));
  }
  if (motion.stops > 0) text += row("gravity", describe_stops(motion));
  if (!motion.wheels && motion.has_calibration_changed) {
    text += row("wheels", "not used: extrinsics differ from those of the map and are not estimated yet");
  } else if (!motion.wheels && !motion.gyroscope) {
    return text + row("motion", "not used: too little motion to estimate the extrinsics");
  }
  const auto bridged = std::ranges::count_if(run.frames, is_bridged);
  return text +
         row("bridged", fmt::format("{} frames without visual pose; {} further frames have a final pose by wheels",
                                    static_cast<int>(bridged), motion.filled_poses));
}

}  // namespace byre
