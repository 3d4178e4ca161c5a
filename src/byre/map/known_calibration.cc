#include "byre/map/map_file.h"

namespace byre {

std::optional<RefinedCalibration> known_calibration(const std::vector<SourceRecording>& recordings,
                                                    const Calibration& given) {
  for (auto recording = recordings.rbegin(); recording != recordings.rend(); ++recording) {
    if (!recording->refined) continue;
    Calibration known = recording->calibration;
    RefinedCalibration refined = *recording->refined;
    if (!given.right) known.right = refined.calibration.right = std::nullopt;
    if (known == given) return refined;
  }
  return std::nullopt;
}

}  // namespace byre
