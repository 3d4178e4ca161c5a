#include "byre/cli/shared/extrinsics_arguments.h"

#include "byre/calibration_file.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/io/calibration/calibration_fields.h"

#include <algorithm>
#include <string>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

// The file of a calibration, given as file or folder, if it has extrinsics among its fields.
std::optional<fs::path> file_with_extrinsics(const fs::path& calibration) {
  const auto file = fs::is_directory(calibration) ? find_calibration(calibration) : std::optional(calibration);
  if (!file || fs::is_directory(*file)) return std::nullopt;  // a folder of two files has no common fields
  const std::vector<std::string> names = CalibrationFields::load(*file).names();
  const auto is_pose = [](const std::string& name) { return name.starts_with("base_from"); };
  return std::ranges::any_of(names, is_pose) ? file : std::nullopt;
}

}  // namespace

std::optional<Extrinsics> ExtrinsicsArguments::read(const OpenOptions& open) const {
  std::optional<fs::path> path = file;
  if (!path && open.calibration) path = file_with_extrinsics(*open.calibration);
  if (!path) return std::nullopt;
  if (open.camera == CameraChoice::right) {
    throw InputError(path->string(), "has the pose of the left camera, and --camera right uses the other one",
                     "leave out --extrinsics, or use --camera left");
  }
  return read_extrinsics(*path, frames);
}

void declare_extrinsics(CLI::App& command, ExtrinsicsArguments& arguments) {
  CLI::Option* const file =
      add_input(
          command, Input::recording, "--extrinsics", arguments.file,
          "Poses of camera and IMU on the robot's base: YAML, URDF, or a bag with /tf_static (those in the file of "
          "--calibration, else estimated while driving)")
          ->type_name("FILE");
  const auto add_frame = [&](const std::string& name, std::string& frame, const std::string& help) {
    add_text(command, name, frame, help)->type_name("NAME")->needs(file);
  };
  add_frame("--base-frame", arguments.frames.base,
            "Frame of the base in a URDF or bag (base_link, else base_footprint)");
  add_frame("--camera-frame", arguments.frames.camera,
            "Optical frame of the left or only camera in a URDF or bag (the only one that ends in optical_frame)");
  add_frame("--imu-frame", arguments.frames.imu, "Frame of the IMU in a URDF or bag (imu_link)");
}

}  // namespace byre::cli
