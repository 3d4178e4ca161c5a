#include "byre/dataset/euroc_sensor.h"
#include "byre/dataset/recording_index.h"
#include "byre/input/input_error.h"
#include "byre/input/text_file.h"

#include <algorithm>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr Timestamp kPairTolerance = std::chrono::milliseconds(2);
constexpr double kMinBaseline = 1e-3;  // metres

struct TimedFile {
  Timestamp time{};
  fs::path path;
};

// A line of data.csv: "1403636584763555584,1403636584763555584.png".
TimedFile parse_timed_file(const TextLine& line, const fs::path& images, const std::string& place) {
  const std::vector<std::string_view> fields = split_fields(line.text);
  const std::optional<Timestamp> time = parse_nanoseconds(fields.front());
  if (!time) throw InputError(place, "\"" + std::string(fields.front()) + "\" is not a time in nanoseconds");
  if (fields.size() < 2 || fields[1].empty()) throw InputError(place, "names no image file");
  return {*time, images / fields[1]};
}

std::vector<TimedFile> read_image_list(const fs::path& camera_folder) {
  const fs::path csv = camera_folder / "data.csv";
  std::vector<TimedFile> files;
  for (const TextLine& line : read_lines(csv)) {
    const std::string place = place_of(csv, line);
    TimedFile file = parse_timed_file(line, camera_folder / "data", place);
    if (!files.empty() && file.time <= files.back().time) {
      throw InputError(place, "the time stamp is not later than the one before it", "sort the lines by time");
    }
    files.push_back(std::move(file));
  }
  if (files.empty()) throw InputError(csv.string(), "lists no images");
  return files;
}

struct EurocCamera {
  EurocSensor sensor;
  std::vector<TimedFile> files;
};

void check_resolution(const EurocCamera& camera, const fs::path& sensor_file) {
  std::vector<fs::path> paths;
  for (const TimedFile& file : camera.files) paths.push_back(file.path);
  const Image image = first_readable(paths);
  const Camera& calibrated = camera.sensor.camera;
  if (image.width == calibrated.width && image.height == calibrated.height) return;
  throw InputError(sensor_file.string() + ": resolution",
                   "is " + std::to_string(calibrated.width) + "x" + std::to_string(calibrated.height) +
                       ", but the images are " + std::to_string(image.width) + "x" + std::to_string(image.height),
                   "use a calibration made at the size of the images");
}

EurocCamera read_camera(const fs::path& folder) {
  EurocCamera camera{read_euroc_sensor(folder / "sensor.yaml"), read_image_list(folder)};
  check_resolution(camera, folder / "sensor.yaml");
  return camera;
}

// The file taken at nearly the same time. Precondition: files ascend in time.
std::optional<fs::path> partner_of(Timestamp time, const std::vector<TimedFile>& files) {
  const auto before = [](const TimedFile& file, Timestamp t) { return file.time < t; };
  auto nearest = std::lower_bound(files.begin(), files.end(), time, before);
  if (nearest != files.begin() && (nearest == files.end() || time - std::prev(nearest)->time < nearest->time - time)) {
    --nearest;
  }
  if (nearest == files.end() || std::chrono::abs(nearest->time - time) > kPairTolerance) return std::nullopt;
  return nearest->path;
}

StereoPartner partner(const EurocSensor& left, const EurocSensor& right, const fs::path& right_folder) {
  const Pose right_from_left = inverse(right.body_from_camera) * left.body_from_camera;
  if (right_from_left.translation.norm() < kMinBaseline) {
    throw InputError((right_folder / "sensor.yaml").string() + ": T_BS", "puts both cameras in the same place",
                     "calibrate the stereo pair, or remove cam1 to use one camera");
  }
  return {right.camera, right_from_left};
}

std::vector<FrameFiles> to_frames(const std::vector<TimedFile>& left) {
  std::vector<FrameFiles> frames;
  for (const TimedFile& file : left) frames.push_back({file.time, file.path, std::nullopt});
  return frames;
}

void add_right_images(std::vector<FrameFiles>& frames, const EurocCamera& right, const fs::path& right_folder) {
  bool any = false;
  for (FrameFiles& frame : frames) {
    frame.right = partner_of(frame.time, right.files);
    any = any || frame.right.has_value();
  }
  if (any) return;
  throw InputError((right_folder / "data.csv").string(), "no image was taken within 2 ms of any of cam0",
                   "check that both cameras use one clock, or remove cam1 to use one camera");
}

}  // namespace

std::optional<fs::path> find_mav_folder(const fs::path& folder) {
  if (fs::is_directory(folder / "mav0" / "cam0")) return folder / "mav0";
  if (fs::is_directory(folder / "cam0")) return folder;
  return std::nullopt;
}

RecordingIndex index_euroc(const fs::path& folder) {
  const std::optional<fs::path> mav = find_mav_folder(folder);
  if (!mav) throw InputError(folder.string(), "holds no folder mav0/cam0");
  const EurocCamera left = read_camera(*mav / "cam0");
  RecordingIndex index;
  index.calibration.left = left.sensor.camera;
  index.calibration.body_from_left = left.sensor.body_from_camera;
  index.frames = to_frames(left.files);

  const fs::path right_folder = *mav / "cam1";
  if (!fs::is_directory(right_folder)) return index;
  const EurocCamera right = read_camera(right_folder);
  index.calibration.right = partner(left.sensor, right.sensor, right_folder);
  add_right_images(index.frames, right, right_folder);
  return index;
}

}  // namespace byre
