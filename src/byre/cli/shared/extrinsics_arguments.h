#pragma once

#include "byre/extrinsics_file.h"
#include "byre/recording.h"

#include <filesystem>
#include <optional>

namespace CLI {
class App;
}  // namespace CLI

namespace byre::cli {

// Extrinsics of the robot on the command line.
struct ExtrinsicsArguments {
  std::optional<std::filesystem::path> file;
  ExtrinsicsFrames frames;

  // Extrinsics of the file, else those among the fields of the calibration given to open the recording; empty if
  // neither has any. Throws InputError for faults of the file.
  std::optional<Extrinsics> read(const OpenOptions& open) const;
};

// --extrinsics, --base-frame, --camera-frame and --imu-frame. The arguments must outlive the parsing.
void declare_extrinsics(CLI::App& command, ExtrinsicsArguments& arguments);

}  // namespace byre::cli
