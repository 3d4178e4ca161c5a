#pragma once

#include "byre/trajectory_file.h"

#include <filesystem>

#include <CLI/App.hpp>

namespace byre::cli {

// --format: of all trajectories that a command writes. The format must outlive the parsing of the command line.
void declare_trajectory_format(CLI::App& command, TrajectoryFormat& format);

// As write_whole has it. Throws InputError when it cannot be written.
void write_whole(const std::filesystem::path& path, const Trajectory& trajectory, TrajectoryFormat format);

}  // namespace byre::cli
