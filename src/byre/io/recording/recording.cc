#include "byre/recording.h"

#include "byre/base/enum_names.h"
#include "byre/calibration_file.h"
#include "byre/geometry/baseline.h"
#include "byre/input_error.h"
#include "byre/io/bag/bag.h"
#include "byre/io/image/image_file.h"
#include "byre/io/recording/bag_recording.h"
#include "byre/io/recording/fitting_pair.h"
#include "byre/io/recording/frame_selection.h"
#include "byre/io/recording/motion_files.h"
#include "byre/io/recording/recording_index.h"
#include "byre/io/recording/video.h"
#include "byre/trajectory_file.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace byre {
namespace {

namespace fs = std::filesystem;

// The camera of the depth images' pixels.
const Camera& depth_lens(const Calibration& calibration) {
  return calibration.depth->camera ? *calibration.depth->camera : calibration.left;
}

class ImageFiles final : public Recording {
 public:
  ImageFiles(RecordingIndex index, MotionSamples motion, int bits)
      : index_(std::move(index)), motion_(std::move(motion)), warnings_(index_.warnings), bits_(bits) {
    for (const FrameFiles& frame : index_.frames) times_.push_back(frame.time);
  }

  const Calibration& calibration() const override { return index_.calibration.cameras; }
  const std::vector<Timestamp>& times() const override { return times_; }
  std::optional<ImageFrame> read(int index) override;
  const MotionSamples& motion() const override { return motion_; }
  const TimeCorrections& time_corrections() const override { return index_.corrections; }
  const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  template <typename AnyImage>
  std::optional<AnyImage> read_calibrated(const fs::path& path, ImageReading<AnyImage> read, const Camera& camera);
  std::optional<Image> read_right(const FrameFiles& files);
  std::optional<DepthImage> read_depth(const FrameFiles& files);

  RecordingIndex index_;               // constant after construction
  MotionSamples motion_;               // constant after construction
  std::vector<Timestamp> times_;       // constant after construction
  std::vector<std::string> warnings_;  // grows with read
  int bits_;                           // bits in use of 16-bit images, constant after construction
};

std::optional<ImageFrame> ImageFiles::read(int index) {
  assert(index >= 0 && index < size());
  const FrameFiles& files = index_.frames[static_cast<std::size_t>(index)];
  std::optional<Image> left = read_calibrated(files.left, try_image(files.left, bits_), calibration().left);
  if (!left) return std::nullopt;
  return ImageFrame{files.time, std::move(*left), read_right(files), read_depth(files)};
}

std::optional<Image> ImageFiles::read_right(const FrameFiles& files) {
  if (!calibration().right) return std::nullopt;
  if (files.right) return read_calibrated(*files.right, try_image(*files.right, bits_), calibration().right->camera);
  warnings_.push_back(files.left.string() + ": has no right image with the same time stamp");
  return std::nullopt;
}

std::optional<DepthImage> ImageFiles::read_depth(const FrameFiles& files) {
  if (!calibration().depth || !files.depth) return std::nullopt;
  return read_calibrated(*files.depth, try_depth_image(*files.depth), depth_lens(calibration()));
}

template <typename AnyImage>
std::optional<AnyImage> ImageFiles::read_calibrated(const fs::path& path, ImageReading<AnyImage> read,
                                                    const Camera& camera) {
  std::optional<AnyImage>& image = read.image;
  if (!image) {
    warnings_.push_back(path.string() + ": " + read.failure);
    return std::nullopt;
  }
  if (image->width == camera.width && image->height == camera.height) return std::move(image);
  warnings_.push_back(path.string() + ": is " + std::to_string(image->width) + "x" + std::to_string(image->height) +
                      " instead of " + std::to_string(camera.width) + "x" + std::to_string(camera.height));
  return std::nullopt;
}

// Bits in use of 16-bit images, by the largest value of images spread over the recording.
int bits_in_use(const std::vector<FrameFiles>& frames) {
  constexpr std::size_t kSamples = 9;
  std::uint16_t largest = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const FrameFiles& frame = frames[i * (frames.size() - 1) / (kSamples - 1)];
    const auto left = largest_value(frame.left);
    if (!left && i == 0) return kWordBits;
    const auto right = frame.right ? largest_value(*frame.right) : std::nullopt;
    largest = std::max({largest, left.value_or(0), right.value_or(0)});
  }
  return bits_of(largest);
}

// Keeps only the frames in range.
RecordingIndex select(RecordingIndex index, const FrameRange& range, const fs::path& path) {
  std::vector<Timestamp> times;
  for (const FrameFiles& frame : index.frames) times.push_back(frame.time);
  std::vector<FrameFiles> selected;
  for (const std::size_t i : frames_in_range(times, range, path)) selected.push_back(index.frames[i]);
  index.frames = std::move(selected);
  return index;
}

// The first readable depth image; throws InputError with its name if there is none.
DepthImage first_readable_depth(const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    if (std::optional<DepthImage> image = read_depth_image(file)) return std::move(*image);
  }
  throw InputError(files.front().string(), "is not a complete 16-bit image, and neither is any other depth image",
                   "store depths in one 16-bit channel, or select the camera alone: left");
}

// Throws InputError if the size of the first readable images differs from the calibration.
void require_calibrated_sizes(const RecordingIndex& index) {
  std::vector<fs::path> left, right, depth;
  for (const FrameFiles& frame : index.frames) {
    left.push_back(frame.left);
    if (frame.right) right.push_back(*frame.right);
    if (frame.depth) depth.push_back(*frame.depth);
  }
  const auto& [cameras, left_size, right_size, depth_size, warnings] = index.calibration;
  const Image first_left = first_readable(left);
  require_calibrated_size(first_left.width, first_left.height, cameras.left, left_size);
  if (cameras.depth && !depth.empty()) {
    const DepthImage first_depth = first_readable_depth(depth);
    require_calibrated_size(first_depth.width, first_depth.height, depth_lens(cameras), depth_size);
  }
  if (!cameras.right || right.empty()) return;
  const Image first_right = first_readable(right);
  require_calibrated_size(first_right.width, first_right.height, cameras.right->camera, right_size);
}

// Completes sizes that the calibration file does not have from the first readable images.
void complete_sizes(RecordingIndex& index) {
  auto& [cameras, left_size, right_size, depth_size, warnings] = index.calibration;
  if (cameras.left.width != 0 && (!cameras.right || cameras.right->camera.width != 0)) return;
  std::vector<fs::path> left, right;
  for (const FrameFiles& frame : index.frames) {
    left.push_back(frame.left);
    if (frame.right) right.push_back(*frame.right);
  }
  const Image first_left = first_readable(left);
  complete_size(cameras.left, first_left.width, first_left.height, left_size);
  if (!cameras.right) return;
  const Image first_right = right.empty() ? first_left : first_readable(right);
  complete_size(cameras.right->camera, first_right.width, first_right.height, right_size);
}

RecordingIndex index_format(RecordingFormat format, const fs::path& path, const OpenOptions& options) {
  switch (format) {
    case RecordingFormat::euroc:
      return index_euroc(path, options);
    case RecordingFormat::kitti:
      return index_kitti(path, options);
    case RecordingFormat::tum:
      return index_tum(path, options);
    case RecordingFormat::images:
      return index_images(path, options);
    case RecordingFormat::video:
    case RecordingFormat::bag:
      break;
  }
  throw InputError(path.string(), "is a " + std::string(to_string(format)) + ", which has no image files",
                   "extract its images into a folder");
}

void require_untimed(RecordingFormat format, const fs::path& path, const OpenOptions& options) {
  if (!options.frame_rate_hz || format == RecordingFormat::images || format == RecordingFormat::video) return;
  throw InputError(path.string(), "has time stamps; a frame rate is not accepted",
                   "omit the frame rate, or give the folder of the images");
}

void require_no_topics(RecordingFormat format, const fs::path& path, const OpenOptions& options) {
  const bool is_any_named = options.left_topic || options.right_topic || options.wheels_topic || options.imu_topic;
  if (format == RecordingFormat::bag || !is_any_named) return;
  throw InputError(path.string(), "is not a bag and has no topics", "omit the topics");
}

void require_no_motion(const fs::path& path, const OpenOptions& options) {
  if (!options.wheels && !options.use_gyroscope) return;
  throw InputError(path.string(), "is a video; wheel and gyroscope samples are read from bags and folders only",
                   "omit them, or extract the images");
}

fs::path calibration_file_for(const fs::path& folder, const OpenOptions& options) {
  if (options.calibration) return *options.calibration;
  if (const std::optional<fs::path> file = find_calibration(folder)) return *file;
  throw InputError(folder.empty() ? "." : folder.string(), "contains no camera calibration",
                   "give one with --calibration FILE, or add it as calibration.yaml, camera.yaml or sensor.yaml");
}

}  // namespace

Image first_readable(const std::vector<fs::path>& files) {
  std::string first_failure;
  for (const fs::path& file : files) {
    ImageReading<Image> read = try_image(file);
    if (read.image) return std::move(*read.image);
    if (first_failure.empty()) first_failure = file.filename().string() + " " + read.failure;
  }
  throw InputError(files.front().parent_path().string(), "no listed image can be read: " + first_failure,
                   "check that the folder is complete");
}

std::string place_of_calibration(const fs::path& recording, const OpenOptions& options) {
  return options.calibration.value_or(recording).string();
}

CalibrationWithSource calibration_for(const fs::path& folder, const OpenOptions& options) {
  const fs::path file = calibration_file_for(folder, options);
  const std::string right = options.right_calibration ? options.right_calibration->string() : file.string();
  const bool is_right = options.camera == CameraChoice::right;
  // Holds the camera in both places, of which choose_calibration takes one.
  const auto camera_alone = [&](const fs::path& camera) {
    Calibration alone = read_calibration_file(camera).calibration;
    if (is_right && !alone.right) alone.right = StereoPartner{alone.left, Pose{}};
    return CalibrationWithSource{alone, camera.string(), camera.string()};
  };
  const bool is_named = file_of_camera(file) != file && !options.right_calibration;
  if (is_named && is_right) return camera_alone(file);
  try {
    return {read_calibration_file(file, options.right_calibration).calibration, file.string(), right};
  } catch (const UnplacedCameras& unplaced) {
    if (!is_right && options.camera != CameraChoice::left) throw;
    const fs::path camera = unplaced.side(is_right);
    CalibrationWithSource alone = camera_alone(camera);
    alone.warnings.push_back(camera.string() + ": this camera is used alone; the file has no relative pose");
    return alone;
  }
}

void complete_size(Camera& camera, int width, int height, const std::string& place) {
  if (camera.width != 0) return;
  camera.width = width;
  camera.height = height;
  if (camera.contains({camera.cx, camera.cy})) return;
  throw InputError(place, "the principal point is outside the images",
                   "check that calibration and images belong together");
}

DepthCameraWithSource depth_camera_for(const fs::path& folder, const OpenOptions& options) {
  const fs::path camera_file = calibration_file_for(folder, options);
  const fs::path extra = folder / "depth.yaml";
  const bool has_extra = !has_depth_camera_fields(camera_file) && fs::is_regular_file(extra);
  const fs::path file = has_extra ? extra : camera_file;
  return {read_depth_camera(file), file.string()};
}

const MotionSamples& Recording::motion() const {
  static const MotionSamples none;
  return none;
}

const TimeCorrections& Recording::time_corrections() const {
  static const TimeCorrections none;
  return none;
}

std::string_view to_string(RecordingFormat format) {
  return name_among<RecordingFormat::bag>({"euroc", "kitti", "tum", "images", "video", "bag"}, format);
}

std::string_view to_string(CameraChoice choice) {
  return name_among<CameraChoice::rgbd>({"stereo", "left", "right", "rgbd"}, choice);
}

RecordingFormat guess_format(const fs::path& path) {
  if (is_video_file(path)) return RecordingFormat::video;
  if (!fs::is_directory(path)) {
    if (is_bag(path)) return RecordingFormat::bag;
    throw InputError(path.string(), "is not a folder, video or bag",
                     "give the folder of a recording, a video file or a bag");
  }
  if (find_mav_folder(path)) return RecordingFormat::euroc;
  if (fs::exists(path / "rgb.txt")) return RecordingFormat::tum;
  if (fs::exists(path / "calib.txt") || fs::is_directory(path / "image_0")) return RecordingFormat::kitti;
  if (is_bag(path)) return RecordingFormat::bag;
  if (has_images(path)) return RecordingFormat::images;
  throw InputError(path.string(), "contains no recording in a supported format",
                   "supported: mav0/cam0 or cam0 (EuRoC), calib.txt or image_0 (KITTI odometry), rgb.txt (TUM RGB-D), "
                   "image files, also in folders left and right");
}

RecordingIndex index_recording(const fs::path& path, const OpenOptions& options) {
  const RecordingFormat format = guess_format(path);
  require_untimed(format, path, options);
  RecordingIndex index = index_format(format, path, options);
  complete_sizes(index);
  return index;
}

std::unique_ptr<Recording> open_recording(const fs::path& path, const FrameRange& range, const OpenOptions& options) {
  const RecordingFormat format = guess_format(path);
  require_no_topics(format, path, options);
  if (format == RecordingFormat::video) {
    require_no_motion(path, options);
    return open_video(path, range, options);
  }
  if (format == RecordingFormat::bag) {
    require_untimed(format, path, options);
    return with_fitting_pair(open_bag_recording(path, range, options), path.string());
  }
  const RecordingIndex whole = index_recording(path, options);
  const ExtraImages extra = extra_images_of(whole);
  require_calibrated_sizes(choose_camera(whole, extra, options.camera, path));
  RecordingIndex chosen = choose_camera(select(whole, range, path), extra, options.camera, path);
  chosen.calibration.cameras = with_checked_baseline(chosen.calibration.cameras, options.baseline,
                                                     place_of_calibration(path, options), "--baseline ");
  SensorMotion motion = read_motion(path, options, chosen.calibration.cameras.body_from_left, whole.clock);
  chosen.warnings.insert(chosen.warnings.end(), motion.warnings.begin(), motion.warnings.end());
  const int bits = whole.frames.empty() ? kWordBits : bits_in_use(whole.frames);
  return with_fitting_pair(std::make_unique<ImageFiles>(std::move(chosen), std::move(motion.samples), bits),
                           path.string());
}

CameraChoice camera_of(const Recording& recording, const OpenOptions& options) {
  if (recording.calibration().right) return CameraChoice::stereo;
  return recording.calibration().depth ? CameraChoice::rgbd : options.camera.value_or(CameraChoice::left);
}

std::optional<fs::path> find_ground_truth(const fs::path& path) {
  const RecordingFormat format = guess_format(path);
  if (format == RecordingFormat::euroc) return find_euroc_ground_truth(path);
  fs::path truth = path / "groundtruth.txt";
  if (format == RecordingFormat::kitti) {
    const fs::path sequence = fs::canonical(path);
    truth = sequence.parent_path().parent_path() / "poses" / (sequence.filename().string() + ".txt");
  }
  return fs::exists(truth) ? std::optional(truth) : std::nullopt;
}

}  // namespace byre
