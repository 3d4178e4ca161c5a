#pragma once

#include "byre/trajectory.h"

#include <filesystem>
#include <optional>

namespace byre {

// A trajectory file in any of the formats; KITTI's poses need the file of their times. Throws InputError.
Trajectory load_trajectory(const std::filesystem::path& path, const std::optional<std::filesystem::path>& times);

// True poses: a trajectory file, or a recording with one. times: replace the recording's own.
Trajectory load_truth(const std::filesystem::path& path, const std::optional<std::filesystem::path>& times = {});

}  // namespace byre
