#include "byre/base/text_file.h"
#include "byre/geometry/evaluation/trajectory_lines.h"
#include "byre/input_error.h"
#include "byre/io/image/image_names.h"
#include "byre/io/recording/recording_index.h"
#include "byre/io/recording/timed_files.h"

#include <cmath>
#include <utility>

#include <Eigen/Core>
#include <fmt/core.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr double kSameFocal = 1e-6;  // relative

// Projection of a rectified camera: [f 0 cx f*tx; 0 f cy 0; 0 0 1 0], with tx the left camera's x in this one, metres.
using Projection = Eigen::Matrix<double, 3, 4>;

Projection parse_projection(const TextLine& line, const std::string& place) {
  const std::vector<std::string_view> fields = split_fields(line.text);
  if (fields.size() != 13) throw InputError(place, "does not have twelve numbers after its name");
  Projection projection;
  for (int i = 0; i < 12; ++i) {
    const std::optional<double> number = parse_number(fields[static_cast<std::size_t>(i) + 1]);
    if (!number) throw InputError(place, "contains a value that is not a number");
    projection(i / 4, i % 4) = *number;
  }
  return projection;
}

// Precondition of all functions below: a rectified camera.
void check_projection(const Projection& projection, const std::string& place) {
  const double fx = projection(0, 0);
  const double fy = projection(1, 1);
  if (fx <= 0.0 || fy <= 0.0) throw InputError(place, "the focal lengths must be positive");
  const bool rectified = std::abs(fx - fy) <= kSameFocal * fx && projection(0, 1) == 0.0 && projection(1, 0) == 0.0 &&
                         projection.row(2) == Eigen::RowVector4d(0.0, 0.0, 1.0, 0.0);
  if (!rectified)
    throw InputError(place, "is not the projection matrix of a rectified camera",
                     "use the calib.txt of KITTI odometry");
}

Projection read_projection(const fs::path& calibration, const std::string& name) {
  for (const TextLine& line : read_lines(calibration)) {
    if (!line.text.starts_with(name + ":")) continue;
    const std::string place = calibration.string() + ": " + name;
    Projection projection = parse_projection(line, place);
    check_projection(projection, place);
    return projection;
  }
  throw InputError(calibration.string() + ": " + name, "is missing");
}

Camera pinhole(const Projection& projection, const Image& image, const std::string& place) {
  Camera camera;
  camera.width = image.width;
  camera.height = image.height;
  camera.fx = projection(0, 0);
  camera.fy = projection(1, 1);
  camera.cx = projection(0, 2);
  camera.cy = projection(1, 2);
  if (camera.contains({camera.cx, camera.cy})) return camera;
  throw InputError(place, "the principal point is outside the images",
                   "check that calibration and images belong to the same sequence");
}

StereoPartner read_partner(const fs::path& calibration, const Projection& left, const Image& image) {
  const std::string place = calibration.string() + ": P1";
  const Projection right = read_projection(calibration, "P1");
  const double baseline = (left(0, 3) - right(0, 3)) / right(0, 0);
  if (baseline <= 0.0) throw InputError(place, "does not place the right camera to the right of the left camera");
  return {pinhole(right, image, place), {Eigen::Quaterniond::Identity(), {-baseline, 0.0, 0.0}}};
}

fs::path image_path(const fs::path& folder, std::size_t number) {
  return folder / fmt::format("{:06}.png", number);
}

std::vector<fs::path> image_paths(const fs::path& folder, std::size_t count) {
  std::vector<fs::path> paths;
  for (std::size_t i = 0; i < count; ++i) paths.push_back(image_path(folder, i));
  return paths;
}

CalibrationWithSource read_projections(const fs::path& file, const Image& image, bool stereo) {
  const Projection projection = read_projection(file, "P0");
  CalibrationWithSource calibration{{}, file.string() + ": P0", file.string() + ": P1"};
  calibration.cameras.left = pinhole(projection, image, calibration.left_size);
  if (stereo) calibration.cameras.right = read_partner(file, projection, image);
  return calibration;
}

// One stamp per line: seconds, or nanoseconds at the start of a line with commas.
std::vector<Timestamp> read_stamps(const fs::path& file) {
  std::vector<Timestamp> stamps;
  for (const TextLine& line : read_lines(file)) stamps.push_back(parse_time(line, place_of(file, line)));
  if (stamps.empty()) throw InputError(file.string(), "contains no times");
  return stamps;
}

}  // namespace

RecordingIndex index_kitti(const fs::path& folder, const OpenOptions& options) {
  const fs::path times_file = folder / "times.txt";
  const RecordedStamps recorded{.stamps = read_stamps(times_file), .is_order_certain = true};  // images are numbered
  RestoredTimes restored = restore_times(recorded);
  require_times(restored.items.size(), restored.corrections.repeated, times_file.string());
  const std::vector<Timestamp>& times = recorded.stamps;
  const std::vector<fs::path> left = image_paths(folder / "image_0", times.size());
  const bool stereo = options.camera != CameraChoice::left && fs::is_directory(folder / "image_1");

  RecordingIndex index;
  for (std::size_t i = 0; i < restored.items.size(); ++i) {
    const std::size_t number = restored.items[i];
    index.frames.push_back({restored.times[i], left[number]});
    if (stereo) index.frames.back().right = image_path(folder / "image_1", number);
  }
  index.warnings = describe(restored.corrections, {times_file.string(), "image", "frame"});
  if (const std::size_t images = images_in(folder / "image_0").size(); images > times.size()) {
    index.warnings.push_back(times_file.string() + ": has " + std::to_string(times.size()) + " times for " +
                             std::to_string(images) + " images: the last " + std::to_string(images - times.size()) +
                             " are ignored");
  }
  index.corrections = std::move(restored.corrections);
  index.clock = std::move(restored.clock);
  index.calibration = options.calibration ? calibration_for(folder, options)
                                          : read_projections(folder / "calib.txt", first_readable(left), stereo);
  return index;
}

}  // namespace byre
