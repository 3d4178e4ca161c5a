#include "byre/io/recording/euroc.h"

#include "byre/base/text_file.h"
#include "byre/calibration_file.h"
#include "byre/input_error.h"
#include "byre/io/calibration/camera_fields.h"
#include "byre/io/recording/recording_index.h"
#include "byre/io/recording/timed_files.h"

#include <iomanip>
#include <limits>
#include <ostream>
#include <sstream>
#include <utility>

namespace byre {
namespace {

void write_matrix(std::ostream& text, const Pose& pose) {
  const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
  text << "T_BS:\n  cols: 4\n  rows: 4\n  data: [";
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) text << rotation(row, column) << ", ";
    text << pose.translation[row] << ",\n         ";
  }
  text << "0.0, 0.0, 0.0, 1.0]\n";
}

void write_list(std::ostream& text, const std::vector<double>& numbers) {
  for (std::size_t i = 0; i < numbers.size(); ++i) text << (i == 0 ? "[" : ", ") << numbers[i];
  text << "]";
}

void write_lens(std::ostream& text, const Camera& camera) {
  KalibrLens lens = kalibr_lens(camera);
  if (camera.model == CameraModel::pinhole || camera.model == CameraModel::radial_tangential) {
    lens.distortion_model = "radial-tangential";
  }
  text << "camera_model: " << lens.camera_model << "\nintrinsics: ";
  write_list(text, lens.intrinsics);
  text << (lens.intrinsics.size() == 4 ? " #fu, fv, cu, cv\n" : "\n");
  text << "distortion_model: " << lens.distortion_model << "\ndistortion_coefficients: ";
  write_list(text, lens.coefficients);
  text << "\n";
}

namespace fs = std::filesystem;

// A line of data.csv: "1403636584763555584,1403636584763555584.png".
TimedFile parse_euroc_line(const TextLine& line, const fs::path& images, const std::string& place) {
  const std::vector<std::string_view> fields = split_fields(line.text);
  const std::optional<Timestamp> time = parse_nanoseconds(fields.front());
  if (!time) throw InputError(place, "\"" + std::string(fields.front()) + "\" is not a time in nanoseconds");
  if (fields.size() < 2 || fields[1].empty()) throw InputError(place, "has no name of an image file");
  return {*time, images / fields[1]};
}

// left: clock of the left images, for images of the right camera.
RestoredFiles read_image_list(const fs::path& camera_folder, const SensorClock& left = {}) {
  const fs::path csv = camera_folder / "data.csv";
  std::vector<TimedFile> files;
  for (const TextLine& line : read_lines(csv)) {
    const std::string place = place_of(csv, line);
    files.push_back(parse_euroc_line(line, camera_folder / "data", place));
  }
  if (files.empty()) throw InputError(csv.string(), "lists no images");
  return restore_files(files, csv.string(), left);
}

StereoPartner read_partner(const EurocSensor& left, const fs::path& right_file) {
  const EurocSensor right = read_euroc_sensor(right_file);
  StereoPartner partner{right.camera, inverse(right.body_from_camera) * left.body_from_camera};
  require_baseline(partner, right_file.string() + ": T_BS");
  return partner;
}

CalibrationWithSource read_sensors(const fs::path& mav, bool has_right) {
  const fs::path left_file = mav / "cam0" / "sensor.yaml", right_file = mav / "cam1" / "sensor.yaml";
  const EurocSensor left = read_euroc_sensor(left_file);
  CalibrationWithSource calibration{{left.camera, std::nullopt, left.body_from_camera},
                                    left_file.string() + ": resolution",
                                    right_file.string() + ": resolution"};
  calibration.cameras.readout_time = left.readout_time;
  if (has_right) calibration.cameras.right = read_partner(left, right_file);
  return calibration;
}

}  // namespace

EurocSensor read_euroc_sensor(const std::filesystem::path& path) {
  const CalibrationFields fields = CalibrationFields::load(path);
  EurocSensor sensor;
  sensor.camera = read_camera_fields(fields, "distortion_coefficients");
  sensor.body_from_camera = fields.pose("T_BS");
  sensor.readout_time = read_readout_time(fields, sensor.camera);
  return sensor;
}

std::string write_euroc_sensor(const EurocSensor& sensor, double rate_hz, const std::string& comment) {
  std::ostringstream text;
  text << std::setprecision(std::numeric_limits<double>::max_digits10);
  text << "sensor_type: camera\ncomment: " << comment << "\n\n# Sensor extrinsics wrt. the body-frame.\n";
  write_matrix(text, sensor.body_from_camera);
  text << "\n# Camera specific definitions.\nrate_hz: " << rate_hz << "\nresolution: [" << sensor.camera.width << ", "
       << sensor.camera.height << "]\n";
  write_lens(text, sensor.camera);
  if (sensor.readout_time != 0.0) text << "readout_time: " << sensor.readout_time << "\n";
  return text.str();
}

std::optional<fs::path> find_mav_folder(const fs::path& folder) {
  if (fs::is_directory(folder / "mav0" / "cam0")) return folder / "mav0";
  if (fs::is_directory(folder / "cam0")) return folder;
  return std::nullopt;
}

RecordingIndex index_euroc(const fs::path& folder, const OpenOptions& options) {
  const std::optional<fs::path> mav = find_mav_folder(folder);
  if (!mav) throw InputError(folder.string(), "contains no folder mav0/cam0");
  const bool has_right = options.camera != CameraChoice::left && fs::is_directory(*mav / "cam1");
  RecordingIndex index;
  index.calibration = options.calibration ? calibration_for(folder, options) : read_sensors(*mav, has_right);
  RestoredFiles left = read_image_list(*mav / "cam0");
  const RestoredFiles right = has_right ? read_image_list(*mav / "cam1", left.clock) : RestoredFiles();
  const Timestamp tolerance = pair_tolerance(options);
  index.frames = frames_of(left.files, right.files, tolerance);
  if (has_right) require_pairs(index.frames, right.files, tolerance, (*mav / "cam1" / "data.csv").string());
  index.warnings = std::move(left.warnings);
  index.warnings.insert(index.warnings.end(), right.warnings.begin(), right.warnings.end());
  index.corrections = std::move(left.corrections);
  index.clock = std::move(left.clock);
  return index;
}

}  // namespace byre
