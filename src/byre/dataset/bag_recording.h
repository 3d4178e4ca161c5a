#pragma once

#include "byre/recording.h"

#include <filesystem>
#include <memory>

namespace byre {

// A bag as a recording of one camera or a pair, read one frame at a time. Its frames have the times of timed_messages,
// and images are pairs when these differ by the tolerance of the options at most. The calibration is that of the
// options, or else of its camera info and /tf_static, or else one that lies beside it. What is damaged, out of order or
// without a partner is counted in the warnings. Throws InputError as open_recording says.
std::unique_ptr<Recording> open_bag_recording(const std::filesystem::path& path, const FrameRange& range,
                                              const OpenOptions& options);

}  // namespace byre
