#pragma once

#include "byre/trajectory.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace byre {

//   tum    "time_s tx ty tz qx qy qz qw", separated by spaces
//   euroc  "time_ns,px,py,pz,qw,qx,qy,qz,..." (state_groundtruth_estimate0/data.csv)
//   kitti  twelve numbers, the rows of world_from_camera, without a time
enum class TrajectoryFormat : std::uint8_t { tum, euroc, kitti };

// Tells the format by the first data line; throws InputError when it is none.
TrajectoryFormat guess_trajectory_format(const std::filesystem::path& path);

// Reads a trajectory that has times (TUM, EuRoC); throws InputError naming file and line on anything else, on time
// stamps out of order, and on a quaternion that is not of unit length (to 1 %).
// A folder may be given: then an EuRoC recording's ground truth is looked for inside it.
Trajectory read_trajectory(const std::filesystem::path& path);

// KITTI poses with the times of a file that read_times understands, one for each pose.
Trajectory read_kitti_poses(const std::filesystem::path& poses, const std::filesystem::path& times);

// Time stamps, one a line and strictly increasing: seconds (KITTI's times.txt), or the nanoseconds that begin a line
// with commas (an EuRoC camera's data.csv). Throws InputError naming file and line.
std::vector<Timestamp> read_times(const std::filesystem::path& path);

// Seconds and metres have nine decimals. KITTI's format has no times. Replaces an older trajectory as a whole or not at
// all. Throws InputError if the file cannot be written, or is there and is no trajectory.
void write_trajectory(const Trajectory& trajectory, const std::filesystem::path& path,
                      TrajectoryFormat format = TrajectoryFormat::tum);

// The ground truth inside a folder laid out as EuRoC does, given the folder that holds mav0 or mav0 itself.
std::optional<std::filesystem::path> find_euroc_ground_truth(const std::filesystem::path& folder);

}  // namespace byre
