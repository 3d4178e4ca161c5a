#include "byre/evaluation/trajectory_output.h"

#include "byre/input/output_file.h"

namespace byre {

void write_whole(const std::filesystem::path& path, const Trajectory& trajectory, TrajectoryFormat format) {
  write_whole(path, [&](const std::filesystem::path& unfinished) { write_trajectory(trajectory, unfinished, format); });
}

}  // namespace byre
