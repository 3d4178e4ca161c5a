#pragma once

#include "byre/recording.h"

#include <filesystem>
#include <memory>

namespace byre {

// Opens a bag as a recording of one camera or a stereo pair, read frame by frame, with the times of timed_messages.
// Images are a pair if their times differ by at most the tolerance of the options. Sources of the calibration, in this
// order: the options, camera info with /tf_static, a file next to the bag. Warnings count messages that are damaged,
// out of order or without a partner. Throws InputError like open_recording.
std::unique_ptr<Recording> open_bag_recording(const std::filesystem::path& path, const FrameRange& range,
                                              const OpenOptions& options);

}  // namespace byre
