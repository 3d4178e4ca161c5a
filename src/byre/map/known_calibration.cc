#include "byre/map/map_file.h"

namespace byre {

std::optional<RefinedCalibration> known_calibration(const std::vector<SourceRecording>& recordings,
                                                    const Calibration& given) {
  Calibration cameras = given;
  cameras.depth.reset();  // a map keeps nothing of it
  for (auto recording = recordings.rbegin(); recording != recordings.rend(); ++recording) {
    if (!recording->refined) continue;
    Calibration known = recording->calibration;
    known.depth.reset();
    RefinedCalibration refined = *recording->refined;
    if (!given.right) known.right = refined.calibration.right = std::nullopt;
    refined.calibration.depth = given.depth;
    if (known == cameras) return refined;
  }
  return std::nullopt;
}

}  // namespace byre
