#include "byre/cli/trajectory_output.h"

#include "byre/cli/output_file.h"

#include <map>
#include <string>

#include <CLI/CLI.hpp>

namespace byre::cli {

void declare_trajectory_format(CLI::App& command, TrajectoryFormat& format) {
  const std::map<std::string, TrajectoryFormat> formats = {
      {"tum", TrajectoryFormat::tum}, {"euroc", TrajectoryFormat::euroc}, {"kitti", TrajectoryFormat::kitti}};
  command
      .add_option("--format", format,
                  "Of the trajectories written: TUM's (default), EuRoC's with nanoseconds, or KITTI's without times")
      ->type_name("tum|euroc|kitti")
      ->transform(CLI::CheckedTransformer(formats).description(""));
}

void write_whole(const std::filesystem::path& path, const Trajectory& trajectory, TrajectoryFormat format) {
  write_whole(path, [&](const std::filesystem::path& unfinished) { write_trajectory(trajectory, unfinished, format); });
}

}  // namespace byre::cli
