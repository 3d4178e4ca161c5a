#include "byre/assessment/motion_report.h"

#include "byre/geometry/degrees.h"
#include "byre/input/report_row.h"

#include <algorithm>

#include <fmt/core.h>

namespace byre {
namespace {

// Length of a map unit by the wheels. Empty if the wheels set the scale, which makes it 1.
std::string describe_lengths(const WheelMounting& wheels, const MapRun& run, bool sees_metres) {
  const double share = 100.0 * wheels.scale_sigma;
  if (sees_metres) {
    return fmt::format("{:.2f} % longer than by camera (sigma {:.2f} %); ", 100.0 * (wheels.metres_per_unit - 1.0),
                       share);
  }
  if (run.is_metric) return "";
  return fmt::format("a unit of the map is {:.3f} m (sigma {:.2f} %); ", wheels.metres_per_unit, share);
}

std::string describe(const WheelMounting& wheels, const MapRun& run, bool sees_metres) {
  const ToldMotion& told = run.told;
  const Eigen::Vector3d& arm = wheels.base_from_body.translation;
  std::string text =
      fmt::format("body {:.2f} m ahead and {:.2f} m to the left of the base; time offset {:.0f} ms to the images; ",
                  arm.x(), arm.y(), 1e3 * told.time_offset);
  text += describe_lengths(wheels, run, sees_metres);
  text += fmt::format("ignored {} times for slip", told.slips);
  return text + (told.is_mounted_otherwise ? "; extrinsics differ from those of the map" : "");
}

std::string describe_stops(const ToldMotion& told) {
  std::string text = fmt::format("{} stops, {:.1f} s", told.stops, told.stood_s);
  if (told.to_keep.up)
    text += fmt::format("; vertical in the map with sigma {:.1f} deg", told.to_keep.up->sigma / kDegree);
  return text + fmt::format("; roll and pitch of {} bridged frames corrected", told.tilts_held);
}

bool is_bridged(const MappedFrame& frame) {
  return frame.report && frame.report->map_from_body && frame.report->health.doubt == Doubt::bridged;
}

}  // namespace

std::string motion_rows(const MapRun& run, bool sees_metres) {
  const ToldMotion& told = run.told;
  if (!told.is_told) return "";
  std::string text;
  if (told.wheels) text += row("wheels", describe(*told.wheels, run, sees_metres));
  if (told.gyroscope) {
    text += row("gyroscope", fmt::format("bias {:.3f}, {:.3f}, {:.3f} deg/s", told.gyroscope->bias.x() / kDegree,
                                         told.gyroscope->bias.y() / kDegree, told.gyroscope->bias.z() / kDegree));
  }
  if (told.stops > 0) text += row("gravity", describe_stops(told));
  if (!told.wheels && told.is_mounted_otherwise) {
    text += row("wheels", "not used: extrinsics differ from those of the map and are not estimated yet");
  } else if (!told.wheels && !told.gyroscope) {
    return text + row("motion", "not used: too little motion to estimate the extrinsics");
  }
  const auto bridged = std::ranges::count_if(run.frames, is_bridged);
  return text +
         row("bridged", fmt::format("{} frames without visual pose; {} further frames have a final pose by wheels",
                                    static_cast<int>(bridged), told.led_afterwards));
}

}  // namespace byre
