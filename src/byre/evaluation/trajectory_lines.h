#pragma once

#include "byre/input/text_file.h"
#include "byre/trajectory.h"

#include <filesystem>
#include <string>

namespace byre {

// Poses in the order of the lines, without a check of the order of times. Otherwise throws InputError as
// read_trajectory does.
Trajectory parse_pose_lines(const std::filesystem::path& path);

// Time at the beginning of a line: nanoseconds if the line has commas, else seconds. Throws InputError with the place.
Timestamp parse_time(const TextLine& line, const std::string& place);

}  // namespace byre
