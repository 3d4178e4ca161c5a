#include "byre/map/map_file.h"

#include <algorithm>

namespace byre {
namespace {

// A map keeps nothing of a depth camera, and one camera may be the left one of a pair.
bool is_of_these_cameras(const Calibration& known, const Calibration& given) {
  return known.left == given.left && known.body_from_left == given.body_from_left &&
         known.readout_time == given.readout_time && (!given.right || known.right == given.right);
}

}  // namespace

bool is_by_cameras_of(const std::vector<SourceRecording>& recordings, const Calibration& given) {
  return std::ranges::any_of(
      recordings, [&](const SourceRecording& recording) { return is_of_these_cameras(recording.calibration, given); });
}

std::optional<RefinedCalibration> known_calibration(const std::vector<SourceRecording>& recordings,
                                                    const Calibration& given) {
  for (auto recording = recordings.rbegin(); recording != recordings.rend(); ++recording) {
    if (!recording->refined || !is_of_these_cameras(recording->calibration, given)) continue;
    std::optional<RefinedCalibration> refined = recording->refined;
    if (!given.right) refined->calibration.right.reset();
    refined->calibration.depth = given.depth;
    return refined;
  }
  return std::nullopt;
}

}  // namespace byre
