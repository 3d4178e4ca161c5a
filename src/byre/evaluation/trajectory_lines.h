#pragma once

#include "byre/input/text_file.h"
#include "byre/trajectory.h"

#include <filesystem>
#include <string>

namespace byre {

// Poses in the order of the file's lines, whatever their times. Throws InputError as read_trajectory does otherwise.
Trajectory parse_pose_lines(const std::filesystem::path& path);

// Time at the beginning of a line: nanoseconds where the line has commas, else seconds. Throws InputError at the place.
Timestamp parse_time(const TextLine& line, const std::string& place);

}  // namespace byre
