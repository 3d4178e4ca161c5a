#include "byre/cli/shared/extrinsics_arguments.h"

#include "byre/cli/shared/file_arguments.h"
#include "byre/io/calibration/calibration_fields.h"

#include <algorithm>
#include <string>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

bool has_extrinsics(const std::filesystem::path& calibration) {
  const std::vector<std::string> names = CalibrationFields::load(calibration).names();
  return std::ranges::any_of(names, [](const std::string& name) { return name.starts_with("base_from"); });
}

}  // namespace

std::optional<Extrinsics> ExtrinsicsArguments::read(const OpenOptions& open) const {
  const auto& path = file ? file : open.calibration && has_extrinsics(*open.calibration) ? open.calibration : file;
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
          "--calibration; without both, found while driving)")
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
