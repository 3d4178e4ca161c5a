#include "byre/base/output_file.h"
#include "byre/calibration_file.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/geometry/degrees.h"
#include "byre/geometry/rectification.h"
#include "byre/input_error.h"
#include "byre/playback/report/report.h"
#include "byre/viewer/calibration_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct CalibrationOptions {
  fs::path input;
  std::optional<fs::path> right;
  std::string size;
  fs::path output;
  std::optional<fs::path> picture;
  bool json = false;
};

constexpr const char* kFooter = R"(Examples:
  byre calibration show calibration.yaml
  byre calibration show left.yaml right.yaml --picture grid.png
  byre calibration show cameras.json#cam3
  byre calibration convert kalibr_imucam_chain.yaml -o calibration.yaml
  byre calibration convert intrinsics.yml extrinsics.yml --size 640x480 -o calibration.yaml

The content determines the format: Kalibr, OpenVINS, EuRoC, ROS (.yaml, .ini, ost.txt), OpenCV (YAML, XML, one camera
or a pair), ORB-SLAM2 and 3, stella_vslam, VINS-Fusion, okvis2, basalt, maplab, DepthAI, ZED (.conf), RealSense, KITTI,
DSO, COLMAP (cameras.txt), OpenSfM, OpenMVG, Metashape, MATLAB, Middlebury, and any file with fx, fy, cx, cy. Two files
are those of the left and the right camera, or intrinsics and extrinsics. A folder stands for both. FILE#NAME is one of
several cameras. "convert" writes a Kalibr camchain, which loses nothing: all lens models are kept. "--picture" draws
the pixel grid of the undistorted image in the image, and the reverse.)";

// Sides of an image from "640x480"; zero if it is none.
std::pair<int, int> sides_of(const std::string& text) {
  int width = 0, height = 0;
  char end = 0;
  constexpr int kMost = 20000;
  if (std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &end) == 2 && width > 0 && height > 0 && width <= kMost &&
      height <= kMost) {
    return {width, height};
  }
  return {0, 0};
}

// Error of a size as text; empty for a valid one.
std::string error_of_size(const std::string& text) {
  return sides_of(text).first > 0 ? "" : "\"" + text + "\" is not WIDTHxHEIGHT";
}

CalibrationReading read(const CalibrationOptions& options) {
  if (options.size.empty()) return read_calibration_file(options.input, options.right);
  const std::pair<int, int> size = sides_of(options.size);
  CalibrationReading reading = read_calibration_file(options.input, options.right, size);
  const int width = size.first, height = size.second;
  const auto complete = [&](Camera& camera) {
    if (camera.width == 0) camera.width = width, camera.height = height;
    if (camera.width == width && camera.height == height && camera.contains({camera.cx, camera.cy})) return;
    throw InputError(options.input.string(),
                     fmt::format("is of {}x{} pixels with the principal point {:g}, {:g}", camera.width, camera.height,
                                 camera.cx, camera.cy),
                     "--size must be the size of the calibrated images");
  };
  complete(reading.calibration.left);
  if (reading.calibration.right) complete(reading.calibration.right->camera);
  return reading;
}

double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) / kDegree;
}

// Angle between the middles of two opposite sides; null if the lens has no ray there.
ordered_json field_of_view(const Camera& camera, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const auto first = camera.bearing(a), second = camera.bearing(b);
  if (camera.width == 0 || !first || !second) return nullptr;
  return degrees_between(*first, *second);
}

ordered_json camera_json(const Camera& camera) {
  const double u = camera.width - 1.0, v = camera.height - 1.0;
  ordered_json json = {{"model", std::string(to_string(camera.model))},
                       {"width", camera.width},
                       {"height", camera.height},
                       {"fx", camera.fx},
                       {"fy", camera.fy},
                       {"cx", camera.cx},
                       {"cy", camera.cy},
                       {"distortion", camera.distortion}};
  json["field_of_view_deg"] = {field_of_view(camera, {0.0, camera.cy}, {u, camera.cy}),
                               field_of_view(camera, {camera.cx, 0.0}, {camera.cx, v})};
  return json;
}

std::string camera_text(const ordered_json& camera) {
  const auto size = camera.at("width") == 0
                        ? std::string("unknown image size")
                        : fmt::format("{}x{}", camera.at("width").get<int>(), camera.at("height").get<int>());
  std::string text =
      fmt::format("{}, {}, fx {:.3f} fy {:.3f} cx {:.3f} cy {:.3f}", camera.at("model").get<std::string>(), size,
                  camera.at("fx").get<double>(), camera.at("fy").get<double>(), camera.at("cx").get<double>(),
                  camera.at("cy").get<double>());
  const ordered_json& field = camera.at("field_of_view_deg");
  if (!field[0].is_null() && !field[1].is_null()) {
    text += fmt::format(", view {:.1f} x {:.1f} deg", field[0].get<double>(), field[1].get<double>());
  }
  return text;
}

std::string distortion_text(const Camera& camera) {
  std::string text;
  auto end = camera.distortion.end();
  while (end != camera.distortion.begin() && *(end - 1) == 0.0) --end;
  for (auto value = camera.distortion.begin(); value != end; ++value) text += fmt::format(" {:.6g}", *value);
  return text.empty() ? "none" : text.substr(1);
}

std::string pose_text(const Pose& pose) {
  constexpr double kPlaces = 1e5;
  const Eigen::Vector3d t = (kPlaces * pose.translation).array().round().matrix() / kPlaces + Eigen::Vector3d::Zero();
  const double angle = angle_between(Eigen::Quaterniond::Identity(), pose.rotation) / kDegree;
  return fmt::format("{:.5f} {:.5f} {:.5f} m, turned by {:.3f} deg", t.x(), t.y(), t.z(), angle);
}

// The rig that byre uses, or why it cannot.
std::string rectified_text(const Calibration& calibration) {
  if (calibration.left.width == 0 || (calibration.right && calibration.right->camera.width == 0)) {
    return "give --size WIDTHxHEIGHT";
  }
  try {
    const Rig rig = rectification_of(calibration).rig;
    return fmt::format("{}x{}, focal length {:.1f} px, view {:.1f} deg", rig.width, rig.height, rig.focal,
                       2.0 * std::atan(0.5 * rig.width / rig.focal) / kDegree);
  } catch (const InputError& error) {
    return error.what();
  }
}

Report calibration_report(const CalibrationOptions& options, const CalibrationReading& reading) {
  const Calibration& calibration = reading.calibration;
  ordered_json json = {{"program", "byre calibration"},
                       {"version", BYRE_VERSION},
                       {"file", options.input.string()},
                       {"format", reading.format},
                       {"left", camera_json(calibration.left)},
                       {"left_in_body", pose_text(calibration.body_from_left)},
                       {"rectified", rectified_text(calibration)},
                       {"notes", reading.notes}};
  if (calibration.right) {
    json["right"] = camera_json(calibration.right->camera);
    json["baseline_m"] = calibration.right->right_from_left.translation.norm();
    json["right_in_left"] = pose_text(inverse(calibration.right->right_from_left));
  }
  if (calibration.readout_time != 0.0) json["readout_time_s"] = calibration.readout_time;
  Report report{std::move(json)};
  report.label_width = 13;
  const auto add_camera = [&report](const char* label, const Camera& camera) {
    report.row(label, "{text}", {{"text", camera_text(report.figures.at(label))}});
    report.row("distortion", "{text}", {{"text", distortion_text(camera)}});
  };
  report.row("format", "{format}");
  add_camera("left", calibration.left);
  if (calibration.right) {
    add_camera("right", calibration.right->camera);
    report.row("baseline", "{baseline_m:.5f} m");
    report.row("right in left", "{right_in_left}");
  }
  report.row("left in body", "{left_in_body}");
  report.row("readout", "{readout_time_s:.4f} s for all rows");
  report.row("rectified", "{rectified}");
  for (const std::string& note : reading.notes) report.row("note", "{text}", {{"text", note}});
  return report;
}

// All cameras of a file without relative poses, each of which is usable alone.
Report unplaced_report(const CalibrationOptions& options, const UnplacedCameras& unplaced) {
  Report report{{{"program", "byre calibration"},
                 {"version", BYRE_VERSION},
                 {"file", options.input.string()},
                 {"cameras", ordered_json::object()},
                 {"notes", ordered_json::array()}}};
  report.label_width = 13;
  std::vector<std::string> notes = {fmt::format("no relative poses: usable with one camera, as {}",
                                                unplaced.camera(unplaced.names().front()).string()),
                                    fmt::format("{}: {}", unplaced.place(), unplaced.reason())};
  for (const std::string& name : unplaced.names()) {
    CalibrationOptions one = options;
    one.input = unplaced.camera(name);
    const CalibrationReading reading = read(one);
    if (!report.figures.contains("format")) {
      report.figures["format"] = reading.format;
      report.row("format", "{format}");
    }
    const ordered_json camera = report.figures["cameras"][name] = camera_json(reading.calibration.left);
    report.row("camera", "{text}", {{"text", name + ": " + camera_text(camera)}});
    report.row("distortion", "{text}", {{"text", distortion_text(reading.calibration.left)}});
    for (const std::string& note : reading.notes) notes.push_back(name + ": " + note);
  }
  report.figures["notes"] = notes;
  for (const std::string& note : notes) report.row("note", "{text}", {{"text", note}});
  return report;
}

ExitCode show_unplaced(const CalibrationOptions& options, const UnplacedCameras& unplaced, std::ostream& result) {
  const Report report = unplaced_report(options, unplaced);
  result << (options.json ? to_json(report) : report.text);
  return ExitCode::done;
}

ExitCode run_show(const CalibrationOptions& options, std::ostream& result) try {
  const CalibrationReading reading = read(options);
  Report report = calibration_report(options, reading);
  if (options.picture) {
    const Calibration& calibration = reading.calibration;
    if (calibration.left.width == 0 || (calibration.right && calibration.right->camera.width == 0)) {
      throw InputError(options.input.string(), "does not have the image size", "give it with --size WIDTHxHEIGHT");
    }
    write_picture(calibration_picture(calibration, options.input.filename().string()), *options.picture);
    report.row("picture", "{path}", {{"path", options.picture->string()}});
  }
  result << (options.json ? to_json(report) : report.text);
  return ExitCode::done;
} catch (const UnplacedCameras& unplaced) {
  if (options.picture) throw;
  return show_unplaced(options, unplaced, result);
}

ExitCode run_convert(const CalibrationOptions& options, std::ostream& result) {
  require_writable(options.output);
  const CalibrationReading reading = read(options);
  if (reading.calibration.left.width == 0) {
    throw InputError(options.input.string(), "does not have the image size", "give it with --size WIDTHxHEIGHT");
  }
  write_atomically(options.output, write_calibration(reading.calibration));
  Report report = calibration_report(options, reading);
  report.row("written", "{path}", {{"path", options.output.string()}});
  result << (options.json ? to_json(report) : report.text);
  return ExitCode::done;
}

std::shared_ptr<CalibrationOptions> declare_input(CLI::App& command) {
  const auto options = std::make_shared<CalibrationOptions>();
  add_input(command, Input::file, "FILE", options->input, "Calibration file, or folder with those of both cameras")
      ->type_name("PATH")
      ->required();
  add_input(command, Input::file, "RIGHT", options->right, "File of the right camera, or of the extrinsics")
      ->type_name("FILE");
  add_text(command, "--size", options->size, "Image size, for files without it or with several")
      ->type_name("WIDTHxHEIGHT")
      ->check(error_of_size);
  command.add_flag("--json", options->json, "Print the result as JSON");
  command.footer(kFooter);
  return options;
}

Action declare_show(CLI::App& command) {
  const auto options = declare_input(command);
  add_output(command, Output::picture, "--picture", options->picture,
             "Pixel grid of the undistorted image in the image of each camera: .svg or .png");
  return [options](std::ostream& result) { return run_show(*options, result); };
}

Action declare_convert(CLI::App& command) {
  const auto options = declare_input(command);
  add_output(command, Output::calibration, "-o,--output", options->output, "Calibration file (Kalibr format)")
      ->type_name("YAML")
      ->required();
  return [options](std::ostream& result) { return run_convert(*options, result); };
}

}  // namespace

Action declare_calibration(CLI::App& command) {
  command.footer(kFooter);
  return declare_subcommands(
      command, {{"show", "Print how a calibration file is understood", declare_show},
                {"convert", "Write a calibration file of any format as Kalibr camchain", declare_convert}});
}

}  // namespace byre::cli
