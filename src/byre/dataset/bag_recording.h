#pragma once

#include "byre/recording.h"

#include <filesystem>
#include <memory>

namespace byre {

// A bag as a recording of one camera or a pair, read one frame at a time. Its frames have the times of timed_messages.
// Images are a pair if their times differ by at most the tolerance of the options. The calibration is that of the
// options, else of camera info and /tf_static, else of a file beside the bag. Warnings count messages that are damaged,
// out of order or without a partner. Throws InputError as open_recording does.
std::unique_ptr<Recording> open_bag_recording(const std::filesystem::path& path, const FrameRange& range,
                                              const OpenOptions& options);

}  // namespace byre
