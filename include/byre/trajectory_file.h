#pragma once

#include "byre/trajectory.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace byre {

//   tum    "time_s tx ty tz qx qy qz qw", separated by spaces
//   euroc  "time_ns,px,py,pz,qw,qx,qy,qz,..." (state_groundtruth_estimate0/data.csv)
//   kitti  twelve numbers, the rows of world_from_camera, without times
enum class TrajectoryFormat : std::uint8_t { tum, euroc, kitti };

// Detects the format from the first data line. Throws InputError if it matches none.
TrajectoryFormat guess_trajectory_format(const std::filesystem::path& path);

// Reads a trajectory with times (TUM, EuRoC), or the ground truth inside an EuRoC folder. Throws InputError with file
// and line for other formats, unordered time stamps, and quaternions whose length is off by more than 1 %.
Trajectory read_trajectory(const std::filesystem::path& path);

// KITTI poses, with one time each from a file for read_times.
Trajectory read_kitti_poses(const std::filesystem::path& poses, const std::filesystem::path& times);

// Reads strictly increasing time stamps, one per line: seconds (KITTI's times.txt), or nanoseconds before a comma (an
// EuRoC camera's data.csv). Throws InputError with file and line.
std::vector<Timestamp> read_times(const std::filesystem::path& path);

// Writes seconds and metres with nine decimals; KITTI without times. Replaces an older trajectory atomically. Throws
// InputError if the file cannot be written, or exists and is no trajectory.
void write_trajectory(const Trajectory& trajectory, const std::filesystem::path& path,
                      TrajectoryFormat format = TrajectoryFormat::tum);

// Ground truth in an EuRoC folder, given the parent of mav0 or mav0 itself. Empty if there is none.
std::optional<std::filesystem::path> find_euroc_ground_truth(const std::filesystem::path& folder);

}  // namespace byre
