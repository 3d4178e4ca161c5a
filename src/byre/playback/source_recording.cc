#include "byre/playback/source_recording.h"

namespace byre {

SourceRecording describe_source(const std::filesystem::path& folder, const Recording& recording,
                                const std::optional<RefinedCalibration>& refined) {
  const std::filesystem::path whole = std::filesystem::weakly_canonical(folder);
  return {whole.filename().string(), recording.calibration(), recording.times().front(), recording.times().back(),
          refined};
}

}  // namespace byre
