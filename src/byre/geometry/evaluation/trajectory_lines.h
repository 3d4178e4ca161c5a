#pragma once

#include "byre/base/text_file.h"
#include "byre/trajectory.h"

#include <filesystem>
#include <string>

namespace byre {

// Poses in file order, without a check of time order. Otherwise throws InputError like read_trajectory.
Trajectory parse_pose_lines(const std::filesystem::path& path);

// Time at the start of a line: nanoseconds if the line has commas, else seconds. Throws InputError with the place.
Timestamp parse_time(const TextLine& line, const std::string& place);

}  // namespace byre
