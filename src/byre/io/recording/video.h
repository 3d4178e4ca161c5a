#pragma once

#include "byre/recording.h"

#include <filesystem>
#include <memory>

namespace byre {

// A video as a recording of one camera, with frames evenly spaced in time. Throws InputError like open_recording.
std::unique_ptr<Recording> open_video(const std::filesystem::path& file, const FrameRange& range,
                                      const OpenOptions& options);

}  // namespace byre
