#pragma once

#include "byre/recording.h"

#include <filesystem>
#include <memory>

namespace byre {

// A video as a recording of one camera, its frames evenly spaced in time. Throws InputError as open_recording says.
std::unique_ptr<Recording> open_video(const std::filesystem::path& file, const FrameRange& range,
                                      const OpenOptions& options);

}  // namespace byre
