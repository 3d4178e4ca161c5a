#include "byre/playback/source_recording.h"

namespace byre {

std::string source_name(const std::filesystem::path& recording) {
  return std::filesystem::weakly_canonical(recording).filename().string();
}

}  // namespace byre
