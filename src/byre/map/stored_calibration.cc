#include "byre/map/stored_calibration.h"

#include <algorithm>

namespace byre {
namespace {

// Ignores depth cameras, which maps do not store. A single given camera may be the left one of a recorded pair.
bool is_of_these_cameras(const Calibration& known, const Calibration& given) {
  return known.left == given.left && known.readout_time == given.readout_time &&
         (!given.right || known.right == given.right);
}

}  // namespace

bool has_same_cameras(const std::vector<SourceRecording>& recordings, const Calibration& given) {
  return std::ranges::any_of(recordings, [&](const SourceRecording& recording) {
    const Calibration& known = recording.calibration;
    return is_of_these_cameras(known, given) && known.body_from_left == given.body_from_left;
  });
}

std::optional<Pose> stored_body_from_body(const std::vector<SourceRecording>& recordings, const Calibration& given) {
  if (has_same_cameras(recordings, given)) return Pose{};
  for (auto recording = recordings.rbegin(); recording != recordings.rend(); ++recording) {
    const Calibration& known = recording->calibration;
    if (is_of_these_cameras(known, given)) return known.body_from_left * inverse(given.body_from_left);
  }
  return std::nullopt;
}

OdometryCalibration odometry_calibration_for(const OdometryCalibration& of_map,
                                             const std::vector<SourceRecording>& recordings, const Calibration& given) {
  const auto body = stored_body_from_body(recordings, given);
  return body ? moved(of_map, *body) : OdometryCalibration{};
}

std::optional<UpInBody> up_of_base(const OdometryCalibration& of_map, const std::vector<SourceRecording>& recordings) {
  constexpr double kMostSigma = 0.1;  // radians
  if (!of_map.wheels || of_map.wheels->tilt_sigma() > kMostSigma) return {};
  const bool are_same = std::ranges::all_of(recordings, [&](const SourceRecording& recording) {
    return has_same_cameras({recordings.front()}, recording.calibration);
  });
  return are_same ? std::optional(UpInBody{of_map.wheels->up_in_body(), of_map.wheels->tilt_sigma()}) : std::nullopt;
}

std::optional<UpInBody> up_of_base(const StoredMap& stored) {
  return up_of_base(read_odometry_calibration(stored.notes), stored.recordings);
}

std::optional<RefinedCalibration> stored_calibration(const std::vector<SourceRecording>& recordings,
                                                     const Calibration& given) {
  for (auto recording = recordings.rbegin(); recording != recordings.rend(); ++recording) {
    if (!recording->refined || !is_of_these_cameras(recording->calibration, given)) continue;
    std::optional<RefinedCalibration> refined = recording->refined;
    if (!given.right) refined->calibration.right.reset();
    refined->calibration.depth = given.depth;
    refined->calibration.body_from_left = given.body_from_left;
    return refined;
  }
  return std::nullopt;
}

}  // namespace byre
