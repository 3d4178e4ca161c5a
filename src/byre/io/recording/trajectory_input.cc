#include "byre/io/recording/trajectory_input.h"

#include "byre/input_error.h"
#include "byre/recording.h"
#include "byre/trajectory_file.h"

namespace byre {

namespace fs = std::filesystem;

Trajectory load_trajectory(const fs::path& path, const std::optional<fs::path>& times) {
  if (times && guess_trajectory_format(path) == TrajectoryFormat::kitti) return read_kitti_poses(path, *times);
  return read_trajectory(path);
}

Trajectory load_truth(const fs::path& path, const std::optional<fs::path>& times) {
  if (!fs::is_directory(path)) return load_trajectory(path, times);
  const std::optional<fs::path> file = find_ground_truth(path);
  if (!file) throw InputError(path.string(), "is a recording without ground truth", "give the ground truth file");
  return load_trajectory(*file, times.value_or(path / "times.txt"));
}

}  // namespace byre
