#include "byre/base/text_file.h"
#include "byre/calibration_file.h"
#include "byre/input_error.h"
#include "byre/io/recording/euroc_sensor.h"
#include "byre/io/recording/recording_index.h"
#include "byre/io/recording/timed_files.h"

#include <utility>

namespace byre {
namespace {

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
