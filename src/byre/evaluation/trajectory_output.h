#pragma once

#include "byre/trajectory_file.h"

#include <filesystem>

namespace byre {

// A file that is whole whenever the program ends, see input/output_file.h. Throws InputError when it cannot be written.
void write_whole(const std::filesystem::path& path, const Trajectory& trajectory,
                 TrajectoryFormat format = TrajectoryFormat::tum);

}  // namespace byre
